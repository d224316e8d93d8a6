//! `bspray inspect --bsp`: the polygon BSP of the models, as figures, as text, and as files to look at.

use std::fmt::Write;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use bspray::accel::bsp::polygon::{PlanFault, SceneTree, SceneTrees};
use bspray::picture::replace_file;
use bspray::scene::Scene;
use clap::Args;
use serde_json::json;

use super::bsp_args::{self, BspArgs};
use super::{Done, UsageError, files, output};

/// Arguments for the polygon BSP.
#[derive(Args, Debug)]
pub(super) struct InspectBspArgs {
    /// Tell of the polygon BSP instead: its size in every order, and the tree if it is small
    #[arg(long)]
    pub(super) bsp: bool,
    /// With --bsp: write the tree in Graphviz's language
    #[arg(long, value_name = "FILE", requires = "bsp")]
    dot: Option<PathBuf>,
    /// With --bsp: draw the tree (SVG); of large trees the upper levels
    #[arg(long, value_name = "FILE", requires = "bsp")]
    svg: Option<PathBuf>,
    /// With --bsp: draw the regions into which the tree divides the plane (SVG); for models of walls that stand on one axis
    #[arg(long, value_name = "FILE", requires = "bsp")]
    regions: Option<PathBuf>,
    #[command(flatten)]
    how: BspArgs,
}

/// Nodes of a tree that is printed.
const SHOWN_NODES: usize = 64;

/// Models that a drawing's title names.
const MOST_TITLED: usize = 3;

/// A file to be written: its place, its content, and what is not in it.
struct Drawn<'a> {
    path: &'a Path,
    content: String,
    note: Option<String>,
}

impl InspectBspArgs {
    /// Files to be written, with the options that name them.
    fn files(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let named = [
            ("--dot", &self.dot),
            ("--svg", &self.svg),
            ("--regions", &self.regions),
        ];
        named
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)))
    }

    /// Finds out before the models are read what would keep the files from being written.
    pub(super) fn check_files(&self) -> anyhow::Result<()> {
        for (number, (_, path)) in self.files().enumerate() {
            files::check_writable(path, self.files().take(number).map(|(_, other)| other))?;
        }
        Ok(())
    }
}

/// Tells of the trees.
pub(super) fn run(
    scene: &Scene,
    models: &[PathBuf],
    args: &InspectBspArgs,
    as_json: bool,
) -> anyhow::Result<Done> {
    files::spare_inputs(args.files().map(|(_, path)| path), scene)?;
    let options = args.how.options(0);
    let trees = SceneTrees::build(scene, &options);
    // All are drawn before the first is written: where one is impossible, none is there.
    let mut drawn = Vec::new();
    for (option, path) in args.files() {
        drawn.push(draw(scene, &trees, models, args, option, path)?);
    }
    for Drawn {
        path,
        content,
        note,
    } in drawn
    {
        replace_file(path, |file| file.write_all(content.as_bytes()))
            .with_context(|| path.display().to_string())?;
        if let Some(note) = note {
            output::message(&format!("{}: {note}", path.display()));
        }
    }
    let rows = bsp_args::orders(scene, &options);
    if as_json {
        let report = json!({ "orders": rows, "shown": args.how.bsp_order.name(),
            "trees": trees.trees().iter().map(|t| t.bsp.to_string()).collect::<Vec<_>>() });
        output::result(&format!("{report:#}"))?;
        return Ok(Done::Completely);
    }
    let mut text = bsp_args::table(&rows);
    for tree in trees.trees() {
        let nodes = tree.bsp.nodes().len();
        let order = args.how.bsp_order;
        if nodes <= SHOWN_NODES {
            let _ = write!(text, "\n{order}:\n{}", tree.bsp);
        }
    }
    output::result(&text)?;
    Ok(Done::Completely)
}

fn draw<'a>(
    scene: &Scene,
    trees: &SceneTrees,
    models: &[PathBuf],
    args: &InspectBspArgs,
    option: &str,
    path: &'a Path,
) -> anyhow::Result<Drawn<'a>> {
    let [tree] = trees.trees() else {
        let cause = format!(
            "{option}: the models have no tree, or several: meshes that are placed more than once have their own"
        );
        bail!(UsageError(cause));
    };
    let mut names: Vec<String> = models.iter().map(|m| name_of(m)).collect();
    if names.len() > MOST_TITLED {
        let more = names.split_off(MOST_TITLED).len();
        names.push(format!("{more} more"));
    }
    let stats = tree.bsp.stats();
    let title = format!(
        "{}: {} polygons in {} fragments, order {}",
        names.join(", "),
        stats.polygons,
        stats.fragments,
        args.how.bsp_order
    );
    let drawing = match option {
        "--svg" => tree.bsp.draw_tree(&title),
        "--regions" => tree
            .bsp
            .draw_regions(&title)
            .map_err(|fault| anyhow::anyhow!(told(scene, tree, models, fault)))?,
        _ => {
            return Ok(Drawn {
                path,
                content: tree.bsp.to_dot(),
                note: None,
            });
        }
    };
    Ok(Drawn {
        path,
        content: drawing.svg,
        note: drawing.note,
    })
}

/// The file's name without its folders.
fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Names file, element and cause.
fn told(scene: &Scene, tree: &SceneTree, models: &[PathBuf], fault: PlanFault) -> String {
    let paths: Vec<String> = models.iter().map(|m| m.display().to_string()).collect();
    let element = match fault {
        PlanFault::NoWall { polygon, .. } => {
            let triangle = tree.bsp.polygons()[polygon as usize].triangles.first();
            let instance = triangle.map_or(0, |&t| tree.name(t).0);
            let name = &scene.instances[instance as usize].name;
            format!("polygon {} of {name:?}: ", u64::from(polygon) + 1)
        }
        _ => String::new(),
    };
    format!("{}: --regions: {element}{fault}", paths.join(", "))
}
