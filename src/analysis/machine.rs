//! The machine that measures, in words.

/// Processor family, system, and those vector instructions of which code may make use: `x86_64 linux sse4.1 avx avx2 fma`.
pub fn machine() -> String {
    let mut parts = vec![
        std::env::consts::ARCH.to_owned(),
        std::env::consts::OS.to_owned(),
    ];
    #[cfg(target_arch = "x86_64")]
    {
        let features = [
            ("sse4.1", std::arch::is_x86_feature_detected!("sse4.1")),
            ("avx", std::arch::is_x86_feature_detected!("avx")),
            ("avx2", std::arch::is_x86_feature_detected!("avx2")),
            ("fma", std::arch::is_x86_feature_detected!("fma")),
            ("avx512f", std::arch::is_x86_feature_detected!("avx512f")),
            ("avx512vl", std::arch::is_x86_feature_detected!("avx512vl")),
        ];
        let present = features.into_iter().filter(|(_, has)| *has);
        parts.extend(present.map(|(name, _)| name.to_owned()));
    }
    parts.join(" ")
}

/// The processor's name, where the system tells it (Linux does).
pub fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    let (_, name) = line.split_once(':')?;
    Some(name.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Vector instructions that the compiler was allowed to use anywhere in the program: those of code that does not choose at run time, such as
/// obvhs's.
pub fn compiled_instructions() -> String {
    let features = [
        ("sse2", cfg!(target_feature = "sse2")),
        ("sse4.1", cfg!(target_feature = "sse4.1")),
        ("avx", cfg!(target_feature = "avx")),
        ("avx2", cfg!(target_feature = "avx2")),
        ("fma", cfg!(target_feature = "fma")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("neon", cfg!(target_feature = "neon")),
    ];
    let present = features.into_iter().filter(|(_, has)| *has);
    let names: Vec<_> = present.map(|(name, _)| name).collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_machine_has_a_family_and_what_the_program_was_compiled_for() {
        let machine = machine();
        assert!(machine.starts_with(std::env::consts::ARCH), "{machine}");
        #[cfg(target_arch = "x86_64")]
        assert!(compiled_instructions().starts_with("sse2"));
        assert!(processor().is_none_or(|name| !name.is_empty() && !name.contains('\n')));
    }
}
