//! Names of channels: what a file accepts, and what the parts of a file become.

use super::safe_text::ascii;
use super::{Channel, Picture, Samples};

/// Longest name that OpenEXR stores.
const MAX_LENGTH: usize = 255;

/// The channels in a file's order, sorted by their names in ASCII; or why the picture cannot be written.
pub(super) fn sorted_channels(picture: &Picture) -> Result<Vec<(String, &Samples)>, String> {
    let window = picture.window;
    if window.pixels() == 0 || picture.display.0 == 0 || picture.display.1 == 0 {
        return Err("a picture needs at least one pixel".to_owned());
    }
    if picture.channels.is_empty() {
        return Err("a picture needs at least one channel".to_owned());
    }
    let mut channels: Vec<(String, &Samples)> = picture
        .channels
        .iter()
        .map(|channel| (ascii(&channel.name), &channel.samples))
        .collect();
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    for (name, samples) in &channels {
        if name.is_empty() || name.len() > MAX_LENGTH {
            return Err(format!(
                "channel {name:?}: names have 1 to {MAX_LENGTH} characters"
            ));
        }
        if samples.len() as u64 != window.pixels() {
            return Err(format!(
                "channel {name:?}: {} values for {} x {} pixels",
                samples.len(),
                window.width,
                window.height
            ));
        }
    }
    match twin(channels.iter().map(|(name, _)| name.as_str())) {
        Some(name) => Err(format!("channel {name:?} is there twice")),
        None => Ok(channels),
    }
}

/// One list of the channels of several parts, each a name and channels, sorted by name; or which name is there twice.
///
/// With several parts a channel's name begins with the part's, or its number where it has no name.
pub(super) fn joined_channels(
    parts: Vec<(Option<String>, Vec<Channel>)>,
) -> Result<Vec<Channel>, String> {
    let several = parts.len() > 1;
    let mut joined = Vec::new();
    for (number, (part, channels)) in parts.into_iter().enumerate() {
        let prefix = part.unwrap_or_else(|| number.to_string()) + ".";
        for mut channel in channels {
            if several && !channel.name.starts_with(&prefix) {
                channel.name.insert_str(0, &prefix);
            }
            joined.push(channel);
        }
    }
    joined.sort_by(|a, b| a.name.cmp(&b.name));
    match twin(joined.iter().map(|channel| channel.name.as_str())) {
        Some(name) => Err(format!("channel {name:?} is there twice")),
        None => Ok(joined),
    }
}

/// The first name that follows itself.
fn twin<'a>(mut sorted_names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut last = None;
    sorted_names.find(|&name| last.replace(name) == Some(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str) -> Channel {
        Channel::new(name, Samples::U32(vec![1]))
    }

    fn names(parts: Vec<(Option<&str>, Vec<&str>)>) -> Result<Vec<String>, String> {
        let parts = parts.into_iter().map(|(part, names)| {
            let channels = names.into_iter().map(channel).collect();
            (part.map(str::to_owned), channels)
        });
        let joined = joined_channels(parts.collect())?;
        Ok(joined.into_iter().map(|channel| channel.name).collect())
    }

    #[test]
    fn one_part_keeps_its_names_and_several_get_theirs() {
        let single = names(vec![(Some("beauty"), vec!["R", "G"])]);
        assert_eq!(single.unwrap(), ["G", "R"]);
        let several = names(vec![
            (Some("beauty"), vec!["R", "beauty.G"]),
            (None, vec!["Z"]),
        ]);
        assert_eq!(several.unwrap(), ["1.Z", "beauty.G", "beauty.R"]);
        let twice = names(vec![(Some("a"), vec!["R"]), (Some("a"), vec!["R"])]);
        assert_eq!(twice.unwrap_err(), "channel \"a.R\" is there twice");
    }

    #[test]
    fn channels_are_sorted_as_openexr_sorts_them() {
        let picture = ["b", "B", "a.x", "a", "a\u{e9}"]
            .into_iter()
            .fold(Picture::new(1, 1), |p, name| p.with_channel(channel(name)));
        let sorted = sorted_channels(&picture).unwrap();
        let names: Vec<&str> = sorted.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["B", "a", "a.x", "a\\u00e9", "b"]);
    }
}
