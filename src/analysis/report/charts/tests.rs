//! Charts have what they were given, on either ground.

use super::*;
use crate::picture::RasterPixels;

fn line_chart() -> Chart {
    let point = |x: f64, y: f64| Point {
        x,
        y,
        across: Some([x * 0.9, x * 1.1]),
        interval: Some([y * 0.8, y * 1.3]),
        label: format!("{x} samples"),
    };
    let series = |name: &str, factor: f64| Series {
        name: name.to_owned(),
        points: [1.0, 4.0, 16.0].map(|x| point(x, factor / x)).to_vec(),
        is_line: true,
    };
    Chart {
        name: "error".into(),
        title: "Error <against> time".into(),
        plot: Plot::Lines(LineChart {
            x: Axis::new("time (s)", Scale::Log),
            y: Axis::new("error", Scale::Log),
            series: vec![series("bsp", 0.5), series("bvh2", 0.9)],
            has_front: true,
        }),
    }
}

fn dot_chart() -> Chart {
    Chart {
        name: "speed".into(),
        title: "Speed".into(),
        plot: Plot::Dots(DotChart {
            axis: Axis::new("Mrays/s", Scale::Linear),
            rows: vec!["eye".into(), "shadow".into()],
            series: vec![
                ("bsp".into(), vec![Some([1.0, 1.5, 2.0]), None]),
                (
                    "bvh2".into(),
                    vec![Some([0.5, 0.6, 0.7]), Some([1.0, 1.0, 1.0])],
                ),
            ],
        }),
    }
}

fn heat_chart() -> Chart {
    Chart {
        name: "heat".into(),
        title: "Failures".into(),
        plot: Plot::Heat(HeatChart {
            label: "rate (%)".into(),
            columns: vec!["near".into(), "far".into()],
            rows: vec!["a".into(), "b".into(), "c".into()],
            values: vec![
                vec![Some(0.0), Some(12.5)],
                vec![None, Some(50.0)],
                vec![Some(1.0), Some(f64::NAN)],
            ],
        }),
    }
}

#[test]
fn svg_has_titles_axes_ticks_legends_and_marks() {
    for (chart, words) in [
        (
            line_chart(),
            &[
                "Error &lt;against&gt; time",
                "time (s)",
                "error",
                "bsp",
                "bvh2",
                "4 samples",
                "0.1",
            ][..],
        ),
        (dot_chart(), &["Mrays/s", "eye", "shadow", "bsp", "0.5"]),
        (heat_chart(), &["rate (%)", "near", "far", "12.50", "50"]),
    ] {
        let svg = chart.svg();
        for word in words {
            // plotters breaks lines around texts.
            assert!(svg.contains(&format!(">\n{word}\n<")), "{word}: {svg}");
        }
        assert!(svg.contains("#FFFFFF") && svg.contains("viewBox=\"0 0 3040 "));
        assert!(svg.contains("width=\"760\""));
        let inline = chart.inline_svg();
        assert!(inline.starts_with("<svg") && inline.trim_end().ends_with("</svg>"));
        assert!(inline.len() < svg.len());
    }
    let circles = line_chart().svg().matches("<circle").count();
    assert_eq!(circles, 3 + 1, "three points and the legend's mark");
}

#[test]
fn pictures_have_ink_where_text_and_marks_are() {
    for chart in [line_chart(), dot_chart(), heat_chart()] {
        let raster = chart.raster();
        let RasterPixels::Rgb(pixels) = &raster.pixels else {
            panic!("no alpha")
        };
        assert_eq!(raster.width, 1520);
        let rows: Vec<&[[u8; 3]]> = pixels.chunks(1520).collect();
        // The title, in the two lines of text at the top.
        let title = rows[16..48].iter().flat_map(|r| &r[24..200]);
        assert!(title.filter(|p| p[0] < 100).count() > 100, "{}", chart.name);
        let share = pixels.iter().filter(|p| **p == [255; 3]).count() * 100 / pixels.len();
        assert!((30..98).contains(&share), "{}: {share} % white", chart.name);
    }
}

#[test]
fn tables_have_every_number() {
    let csv = line_chart().table().csv();
    assert!(csv.starts_with("series,time (s),lower end of time (s),upper end of time (s),error,lower end of error,upper end of error,label\n"));
    assert_eq!(csv.lines().count(), 7);
    assert!(csv.contains("\nbvh2,4,3.6,4.4,0.225,"));
    let csv = dot_chart().table().csv();
    assert!(csv.contains("\neye,bsp,1,1.5,2\nshadow,bsp,,,\n"), "{csv}");
    let csv = heat_chart().table().csv();
    assert!(csv.contains("\nb,near,\nb,far,50\n"), "{csv}");
}

#[test]
fn charts_without_points_are_drawn_all_the_same() {
    let mut chart = line_chart();
    if let Plot::Lines(lines) = &mut chart.plot {
        lines.series.clear();
    }
    assert!(chart.svg().contains("time (s)"));
    let mut chart = dot_chart();
    if let Plot::Dots(dots) = &mut chart.plot {
        dots.series[0].1 = vec![None, None];
        dots.series[1].1 = vec![Some([0.0; 3]), Some([f64::NAN; 3])];
        dots.axis.scale = Scale::Log;
    }
    assert!(chart.svg().contains("shadow"));
}
