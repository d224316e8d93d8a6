//! What a picture used of what its scene holds, as a table and as JSON.

use std::fmt::Write;

use bspray::analysis::{Needs, Share};
use bspray::scene::Scene;
use serde_json::{Map, Value, json};

/// Rows of meshes that are shown without `--json`.
const SHOWN_MESHES: usize = 20;

/// As JSON.
pub(super) fn value(needs: &Needs) -> Value {
    let share = |share: Share| json!({ "held": share.held, "used": share.used });
    let rows = needs.rows().into_iter();
    let mut value: Map<String, Value> = rows
        .map(|(name, row)| (name.replace(' ', "_"), share(row)))
        .collect();
    value.insert("structure_bytes".to_owned(), json!(needs.structure_bytes));
    Value::Object(value)
}

/// As a table.
pub(super) fn table(needs: &Needs) -> String {
    let mut out = format!(
        "{:<24}{:>14}{:>14}{:>8}\n",
        "needs", "in the scene", "used", "share"
    );
    for (name, share) in needs.rows() {
        let _ = writeln!(
            out,
            "{name:<24}{:>14}{:>14}{:>8}",
            share.held,
            share.used,
            percent(share)
        );
    }
    out
}

/// The used share, or a dash where there is nothing.
fn percent(share: Share) -> String {
    match share.held {
        0 => "-".to_owned(),
        held => format!("{:.1} %", 100.0 * share.used as f64 / held as f64),
    }
}

/// A row a mesh, those with the most unused triangles first.
pub(super) fn meshes(needs: &Needs, scene: &Scene) -> String {
    let unused =
        |mesh: usize| scene.meshes[mesh].triangles.len() as u64 - needs.triangles_of_mesh[mesh];
    let mut order: Vec<usize> = (0..scene.meshes.len()).collect();
    order.sort_by_key(|&mesh| (std::cmp::Reverse(unused(mesh)), mesh));
    let mut out = format!(
        "{:<24}{:>14}{:>14}{:>8}\n",
        "mesh", "triangles", "used", "share"
    );
    for &mesh in order.iter().take(SHOWN_MESHES) {
        let share = Share {
            held: scene.meshes[mesh].triangles.len() as u64,
            used: needs.triangles_of_mesh[mesh],
        };
        let name: String = format!("{mesh} {}", scene.meshes[mesh].name)
            .chars()
            .take(23)
            .collect();
        let (held, used, percent) = (share.held, share.used, percent(share));
        let _ = writeln!(out, "{name:<24}{held:>14}{used:>14}{percent:>8}");
    }
    if order.len() > SHOWN_MESHES {
        let more = order.len() - SHOWN_MESHES;
        let _ = writeln!(out, "... {more} more; --json has all");
    }
    out
}
