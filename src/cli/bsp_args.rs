//! Arguments for how a BSP is built, and the report on the polygon tree in all its orders.

use bspray::accel::bsp::polygon::{SceneTrees, TreeStats};
use bspray::accel::{BspAxes, BspInstructions, BspOrder, BspQuality, BuildOptions, BuildTime};
use bspray::scene::Scene;
use clap::Args;
use serde_json::{Value, json};

/// How a BSP is built.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct BspArgs {
    /// Time spent on building `bsp` against speed of its answers: `fast`, `default`, `best`, or `auto`, by the number of rays that a picture needs
    #[arg(long, value_name = "QUALITY", default_value = AUTO, value_parser = quality)]
    bsp_quality: Quality,
    /// Whether the planes of `bsp` lie along the polygons' dominant normals where that pays, or along the axes of space
    #[arg(long, value_name = "AXES", default_value_t = BspAxes::default(), value_parser = axes)]
    bsp_axes: BspAxes,
    /// With which instructions `bsp` is walked; the answers are the same
    #[arg(long, value_name = "NAME", default_value_t = BspInstructions::default(), value_parser = instructions)]
    bsp_instructions: BspInstructions,
    /// When `bsp`, and meshes that are placed several times under `bvh2` and `cwbvh`, are built: all `ahead` of the first ray, each part when it is `reached` by one, or
    /// `auto`: for pictures of few rays `reached`; the answers are the same
    #[arg(long, value_name = "TIME", default_value = AUTO, value_parser = time)]
    build: Time,
    /// Which polygon `bsp-polygon` inserts next
    #[arg(long, value_name = "ORDER", default_value_t = BspOrder::default(), value_parser = order)]
    pub(super) bsp_order: BspOrder,
    /// Whether neighbours that lie exactly in one plane enter `bsp-polygon` as one polygon
    #[arg(long)]
    bsp_merge: bool,
}

/// The choice by the number of rays.
const AUTO: &str = "auto";

/// A quality, or none for the choice by the number of rays.
#[derive(Clone, Copy, Debug)]
struct Quality(Option<BspQuality>);

/// When what is built, or none for the choice by the number of rays.
#[derive(Clone, Copy, Debug)]
struct Time(Option<BuildTime>);

impl BspArgs {
    /// For as many rays as anybody may ask.
    pub(super) fn options(&self, seed: u32) -> BuildOptions {
        self.options_for(seed, BspQuality::default(), BuildTime::default())
    }

    /// For rays for which these are the best that `auto` may be.
    pub(super) fn options_for(
        &self,
        seed: u32,
        quality: BspQuality,
        time: BuildTime,
    ) -> BuildOptions {
        BuildOptions {
            quality: self.bsp_quality.0.unwrap_or(quality),
            time: self.build.0.unwrap_or(time),
            axes: self.bsp_axes,
            instructions: self.bsp_instructions,
            order: self.bsp_order,
            merges_coplanar: self.bsp_merge,
            seed: u64::from(seed),
            ..BuildOptions::default()
        }
    }
}

/// The one of `all` that has the name.
pub(super) fn one_of<T: Copy, const N: usize>(
    all: [T; N],
    name: fn(T) -> &'static str,
    text: &str,
) -> Result<T, String> {
    all.into_iter()
        .find(|&x| name(x) == text)
        .ok_or_else(|| format!("want one of {}", all.map(name).join(", ")))
}

fn quality(text: &str) -> Result<Quality, String> {
    if text == AUTO {
        return Ok(Quality(None));
    }
    let named = one_of(BspQuality::ALL, BspQuality::name, text);
    named
        .map(|q| Quality(Some(q)))
        .map_err(|all| format!("{all}, {AUTO}"))
}

fn time(text: &str) -> Result<Time, String> {
    if text == AUTO {
        return Ok(Time(None));
    }
    let named = one_of(BuildTime::ALL, BuildTime::name, text);
    named
        .map(|time| Time(Some(time)))
        .map_err(|all| format!("{all}, {AUTO}"))
}

fn axes(text: &str) -> Result<BspAxes, String> {
    one_of(BspAxes::ALL, BspAxes::name, text)
}

fn instructions(text: &str) -> Result<BspInstructions, String> {
    let wanted = one_of(BspInstructions::ALL, BspInstructions::name, text)?;
    let missing = || format!("this machine has no {wanted}");
    wanted.is_available().then_some(wanted).ok_or_else(missing)
}

fn order(text: &str) -> Result<BspOrder, String> {
    one_of(BspOrder::ALL, BspOrder::name, text)
}

/// What the trees are that a picture shows, in one line.
pub(super) fn describe(trees: &SceneTrees) -> String {
    let all: Vec<_> = trees.trees().iter().map(|t| t.bsp.stats()).collect();
    let count = |of: fn(&TreeStats) -> u64| all.iter().map(of).sum::<u64>();
    let undivided = match count(|s| s.unsplit) {
        0 => String::new(),
        fragments => format!(", {fragments} of them in undivided cells"),
    };
    let counted = |n: u64, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let (fragments, polygons) = (count(|s| s.fragments), count(|s| s.polygons));
    let depth = match trees.depth().saturating_sub(1) {
        0 => "depth 0 everywhere".to_owned(),
        most => {
            format!("depth from 0 (violet) to {most} (yellow), in equal steps for each doubling")
        }
    };
    format!(
        "polygon BSP: {} of {}{undivided}; {depth}",
        counted(fragments, "fragment"),
        counted(polygons, "polygon"),
    )
}

/// The polygon trees of the scene, sums over them, in every order.
pub(super) fn orders(scene: &Scene, options: &BuildOptions) -> Value {
    let rows = BspOrder::ALL.map(|order| {
        let trees = SceneTrees::build(scene, &BuildOptions { order, ..*options });
        let all: Vec<_> = trees.trees().iter().map(|t| t.bsp.stats()).collect();
        let sum = |count: fn(&TreeStats) -> u64| -> u64 { all.iter().map(count).sum() };
        let (fragments, polygons) = (sum(|s| s.fragments), sum(|s| s.polygons));
        // A tree's mean counts by its size.
        let depths: f64 = all.iter().map(|s| s.mean_leaf_depth * s.nodes as f64).sum();
        json!({
            "order": order.name(),
            "polygons": polygons,
            "left_out": sum(|s| s.left_out),
            "nodes": sum(|s| s.nodes),
            "depth": all.iter().map(|s| s.depth).max().unwrap_or(0),
            "mean_leaf_depth": depths / sum(|s| s.nodes).max(1) as f64,
            "splits": sum(|s| s.splits),
            "fragments": fragments,
            "fragments_per_polygon": fragments as f64 / polygons.max(1) as f64,
            "unsplit": sum(|s| s.unsplit),
        })
    });
    json!(rows)
}

/// The rows as a table.
pub(super) fn table(rows: &Value) -> String {
    let head = [
        "order",
        "polygons",
        "nodes",
        "depth",
        "mean depth",
        "splits",
        "fragments",
        "a polygon",
    ];
    let mut out = format!("{:<14}", head[0]);
    head[1..].iter().for_each(|h| out += &format!("{h:>11}"));
    for row in rows.as_array().into_iter().flatten() {
        let real = |key: &str| format!("{:.2}", row[key].as_f64().unwrap_or_default());
        out += &format!("\n{:<14}", row["order"].as_str().unwrap_or_default());
        for cell in [
            row["polygons"].to_string(),
            row["nodes"].to_string(),
            row["depth"].to_string(),
            real("mean_leaf_depth"),
            row["splits"].to_string(),
            row["fragments"].to_string(),
            real("fragments_per_polygon"),
        ] {
            out += &format!("{cell:>11}");
        }
    }
    out + "\n"
}
