//! A report of every kind of section, in all its files.

use super::*;
use crate::picture::{Channel, Picture, Raster, Samples};

fn raster(light: f32) -> Raster {
    Raster::from_rgb(40, 30, &[[light, 0.5, 0.1]; 1200])
}

fn full() -> Report {
    let provenance = Provenance::of_run("bspray test 'a <b>'").with("seed", "7");
    let mut report = Report::new("All & everything", provenance);
    report.push(Section::Verdict(Tone::Bad, "1 < 2 is wrong.".into()));
    report.push(Section::Heading("Numbers".into()));
    report.push(Section::Paragraph("In words.".into()));
    let mut table = Table::new("numbers", "Numbers", &["name", "x (s)"]);
    for (name, x) in [("b", 10.0), ("a", 9.123_456_789), ("c", 1e-9)] {
        table.push(vec![name.into(), x.into()]);
    }
    report.push(Section::Table(table));
    let dots = DotChart {
        axis: Axis::new("speed", Scale::Log),
        rows: vec!["eye".into()],
        series: vec![("bsp".into(), vec![Some([1.0, 2.0, 3.25])])],
    };
    report.push(Section::Chart(Chart {
        name: "speed".into(),
        title: "Speed".into(),
        plot: Plot::Dots(dots),
    }));
    report.push(Section::Picture(ShownPicture {
        name: "heat".into(),
        title: "Heat".into(),
        raster: raster(0.3),
    }));
    report.push(Section::Pair(PicturePair {
        name: "pair".into(),
        title: "Two".into(),
        left: ("before".into(), raster(0.1)),
        right: ("after".into(), raster(0.9)),
    }));
    report.push(Section::Layers(Layers {
        name: "layers".into(),
        title: "Depths".into(),
        picture: Picture::new(1, 1).with_channel(Channel::new("Z", Samples::F32(vec![2.0]))),
    }));
    report
}

#[test]
fn the_folder_has_every_file_and_every_number() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("a/b");
    full().write(&inner).unwrap();
    let mut names: Vec<_> = std::fs::read_dir(&inner)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = [
        "heat.png",
        "layers.exr",
        "numbers.csv",
        "pair-left.png",
        "pair-right.png",
        "report.html",
        "report.json",
        "speed.csv",
        "speed.png",
        "speed.svg",
    ];
    assert_eq!(names, expected);
    let read = |name: &str| std::fs::read_to_string(inner.join(name)).unwrap();
    assert!(read("numbers.csv").contains("\na,9.123456789\n"));
    assert!(read("speed.csv").contains("\neye,bsp,1,2,3.25\n"));
    let json: Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(json["tables"]["numbers"]["rows"][1]["x (s)"], 9.123_456_789);
    assert_eq!(
        json["tables"]["speed"]["rows"][0]["upper end of speed"],
        3.25
    );
    assert_eq!(json["words"][0]["tone"], "bad");
    assert_eq!(json["provenance"]["seed"], "7");
    assert_eq!(json["provenance"]["command line"], "bspray test 'a <b>'");
    // Once more over it: files are replaced.
    full().write(&inner).unwrap();
}

#[test]
fn the_page_is_well_formed_and_needs_nothing_else() {
    let html = full().html();
    for words in [
        "<title>All &amp; everything</title>",
        "<p class=\"verdict bad\">1 &lt; 2 is wrong.</p>",
        "data-v=\"9.123456789\">9.123<",
        "<dd>bspray test 'a &lt;b&gt;'</dd>",
        "aria-label=\"before or after\"",
    ] {
        assert!(html.contains(words), "{words}");
    }
    for outside in ["http://", "https://", "src=\"//", "@import", "url("] {
        let mentions = html.matches(outside).count();
        let names_of_svg = html.matches("xmlns=\"http://www.w3.org/2000/svg\"").count();
        let allowed = if outside == "http://" {
            names_of_svg
        } else {
            0
        };
        assert_eq!(mentions, allowed, "{outside}");
    }
    assert_eq!(html.matches("data:image/png;base64,").count(), 3);
    assert_nested(&html);
}

/// Every element that must be closed is, in order.
fn assert_nested(html: &str) {
    let mut open: Vec<&str> = Vec::new();
    let (before, rest) = html.split_once("<style>").unwrap();
    let (_, rest) = rest.split_once("</style>").unwrap();
    let (body, script) = rest.split_once("<script>").unwrap();
    let (_, after) = script.split_once("</script>").unwrap();
    let markup = [before, body, after].concat();
    for tag in markup.split('<').skip(1) {
        let tag = tag.split('>').next().unwrap();
        let name = tag.split([' ', '\n', '/']).find(|n| !n.is_empty()).unwrap();
        let is_void = ["!DOCTYPE", "meta", "link", "img", "input"].contains(&name);
        if is_void || tag.ends_with('/') {
            continue;
        }
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "{tag}");
        } else {
            open.push(name);
        }
    }
    assert_eq!(open, [""; 0]);
}

#[test]
#[should_panic(expected = "is there twice")]
fn two_sections_of_one_name_are_refused() {
    let mut report = full();
    report.push(Section::Table(Table::new("heat", "", &[])));
}
