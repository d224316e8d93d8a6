//! The page of a report in a browser: nothing on its console, tables that sort, charts, and a slider that works. Without Chromium it is left out, with a word.

use std::path::Path;
use std::process::Command;

use bspray::analysis::report::{
    Axis, Chart, DotChart, HeatChart, LineChart, PicturePair, Plot, Point, Provenance, Report,
    Scale, Section, Series, ShownPicture, Table, Tone,
};
use bspray::picture::{Raster, palette};

const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// What a person would do, and what is then on the page: written where the test finds it.
const PROBE: &str = r##"<script>
const told = [];
const table = document.querySelector("#methods");
const column = () => [...table.tBodies[0].rows].map((row) => row.cells[1].dataset.v).join(" ");
told.push("unsorted " + column());
const button = table.tHead.rows[0].cells[1].querySelector("button");
button.click();
told.push("up " + column());
button.click();
told.push("down " + column());
table.tHead.rows[0].cells[0].querySelector("button").click();
told.push("names " + [...table.tBodies[0].rows].map((row) => row.cells[0].textContent).join(" "));
const slider = document.querySelector(".pair input");
const top_ = document.querySelector(".pair .top");
const clip = () => getComputedStyle(top_).clipPath;
told.push("middle " + clip());
slider.value = 80;
slider.dispatchEvent(new Event("input"));
told.push("right " + clip());
const charts = [...document.querySelectorAll(".chart svg")].map((svg) => svg.getBoundingClientRect());
told.push("charts " + charts.filter((box) => box.width > 300 && box.height > 100).length);
const images = [...document.images];
told.push("images " + images.filter((image) => image.naturalWidth > 0).length);
const texts = [...document.querySelectorAll(".chart text")];
told.push("inked " + texts.some((text) => getComputedStyle(text).fill === getComputedStyle(document.body).color));
told.push("wide " + (document.documentElement.scrollWidth > window.innerWidth));
const probe = document.createElement("pre");
probe.id = "probe";
probe.textContent = told.join("\n");
document.body.append(probe);
</script>
"##;

fn raster(shift: f32) -> Raster {
    let pixels: Vec<[f32; 3]> = (0..320 * 200)
        .map(|i| palette::magma((i % 320) as f32 / 320.0 + shift))
        .collect();
    Raster::from_rgb(320, 200, &pixels)
}

/// A report with every kind of chart, table and picture.
fn report() -> Report {
    let mut report = Report::new("A page of everything", Provenance::of_run("bspray test"));
    let words = "bsp never failed; bvh2 failed in 3 of 1000 rays at the largest scale.";
    report.push(Section::Verdict(Tone::Mixed, words.into()));
    let mut table = Table::new("methods", "Methods", &["method", "time (s)", "rays"]);
    for (name, time, rays) in [
        ("bsp", 9.5, 1000),
        ("cwbvh", 10.25, 10),
        ("bvh2", 0.75, 200),
    ] {
        table.push(vec![name.into(), time.into(), (rays as u64).into()]);
    }
    report.push(Section::Table(table));
    let series = |name: &str, base: f64| Series {
        name: name.into(),
        points: (0..6)
            .map(|i| {
                let x = libm::exp10(f64::from(i) - 2.0);
                let y = base / (0.3 + x) * (1.0 + 0.2 * libm::sin(f64::from(i)));
                Point {
                    across: None,
                    x,
                    y,
                    interval: Some([y * 0.7, y * 1.4]),
                    label: String::new(),
                }
            })
            .collect(),
        is_line: true,
    };
    let axis = |label: &str| Axis::new(label, Scale::Log);
    let lines = LineChart {
        x: axis("scale of the model"),
        y: axis("failure rate"),
        series: vec![
            series("bsp", 0.02),
            series("bvh2", 0.2),
            series("cwbvh", 0.09),
        ],
        has_front: false,
    };
    let mut chart = |name: &str, title: &str, plot: Plot| {
        report.push(Section::Chart(Chart {
            name: name.into(),
            title: title.into(),
            plot,
        }));
    };
    chart(
        "rates",
        "Failure rate against scale, 95 % intervals",
        Plot::Lines(lines),
    );
    let scatter = |name: &str, points: &[(f64, f64, &str)]| Series {
        name: name.into(),
        points: points
            .iter()
            .map(|&(x, y, label)| Point {
                across: None,
                x,
                y,
                interval: None,
                label: label.into(),
            })
            .collect(),
        is_line: false,
    };
    let front = LineChart {
        x: Axis::new("time (s)", Scale::Linear),
        y: Axis::new("error", Scale::Linear),
        series: vec![
            scatter(
                "bsp",
                &[
                    (1.0, 0.9, "fast"),
                    (2.0, 0.4, "default"),
                    (4.5, 0.3, "best"),
                ],
            ),
            scatter("bvh2", &[(1.5, 1.0, "2 bins"), (3.0, 0.35, "16 bins")]),
        ],
        has_front: true,
    };
    chart(
        "front",
        "Time against error, and the Pareto front",
        Plot::Lines(front),
    );
    let dots = DotChart {
        axis: Axis::new("million rays a second", Scale::Linear),
        rows: vec!["eye rays".into(), "shadow rays".into()],
        series: vec![
            (
                "bsp".into(),
                vec![Some([3.8, 4.0, 4.1]), Some([5.0, 5.3, 5.4])],
            ),
            (
                "bvh2".into(),
                vec![Some([1.9, 2.0, 2.4]), Some([2.5, 2.6, 2.65])],
            ),
        ],
    };
    chart("speed", "Speed", Plot::Dots(dots));
    let heat = HeatChart {
        label: "failures in a million rays".into(),
        columns: vec!["1".into(), "100".into(), "1e4".into()],
        rows: vec!["bsp".into(), "bvh2".into()],
        values: vec![vec![Some(0.0); 3], vec![Some(0.0), Some(12.5), Some(730.0)]],
    };
    chart("heat", "Failures by scale", Plot::Heat(heat));
    report.push(Section::Picture(ShownPicture {
        name: "map".into(),
        title: "A heat map".into(),
        raster: raster(0.0),
    }));
    report.push(Section::Pair(PicturePair {
        name: "pair".into(),
        title: "Two pictures".into(),
        left: ("16 samples".into(), raster(-0.3)),
        right: ("256 samples".into(), raster(0.0)),
    }));
    report
}

/// What a browser makes of a page, and what it says of it; `None` without a browser.
fn browse(page: &Path, profile: &Path) -> Option<(String, String)> {
    let profile = format!("--user-data-dir={}", profile.display());
    let url = format!("file://{}", page.display());
    BROWSERS.into_iter().find_map(|browser| {
        let mut command = Command::new(browser);
        command.args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
        ]);
        command.args([
            "--enable-logging=stderr",
            "--window-size=1280,900",
            "--dump-dom",
        ]);
        let output = command.args([&profile, &url]).output().ok()?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Some((text(&output.stdout), text(&output.stderr)))
    })
}

#[test]
fn the_page_works_in_a_browser() {
    let folder = tempfile::tempdir().unwrap();
    report().write(folder.path()).unwrap();
    let page = folder.path().join("report.html");
    let html = std::fs::read_to_string(&page).unwrap();
    let probed = folder.path().join("probed.html");
    std::fs::write(&probed, html.replace("</body>", &format!("{PROBE}</body>"))).unwrap();
    let Some((dom, console)) = browse(&probed, &folder.path().join("profile")) else {
        println!("left out: there is no Chromium on this machine");
        return;
    };
    let said: Vec<&str> = console.lines().filter(|l| l.contains("CONSOLE")).collect();
    assert_eq!(said, [""; 0]);
    let (_, told) = dom
        .split_once("<pre id=\"probe\">")
        .unwrap_or_else(|| panic!("the script did not run to its end:\n{console}"));
    let told: Vec<&str> = told.split("</pre>").next().unwrap().lines().collect();
    let expected = [
        "unsorted 9.5 10.25 0.75",
        "up 0.75 9.5 10.25",
        "down 10.25 9.5 0.75",
        "names bsp bvh2 cwbvh",
        "middle inset(0px 50% 0px 0px)",
        "right inset(0px 20% 0px 0px)",
        "charts 4",
        "images 3",
        "inked true",
        "wide false",
    ];
    assert_eq!(told, expected);
}
