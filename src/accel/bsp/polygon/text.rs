//! A tree as text, and for Graphviz.

use std::fmt::{self, Write};

use super::tree::{Node, PolygonBsp};

/// Deeper nodes are not indented further: a chain of a million would be a text of a terabyte.
const MOST_INDENT: u32 = 40;

impl PolygonBsp {
    fn label(&self, node: &Node) -> String {
        let names: Vec<String> = node.fragments().map(|f| self.name(f)).collect();
        let names = names.join(" ");
        match (node.plane(), names.is_empty()) {
            (Some(plane), true) => format!("plane {plane}"),
            (Some(_), false) => names,
            (None, _) => format!("undivided: {names}"),
        }
    }

    /// The tree in Graphviz's language: a box a node, its fragments in it, edges to what is behind (left) and in front (right).
    pub fn to_dot(&self) -> String {
        let mut dot = String::from("digraph bsp {\n  node [shape=box];\n");
        for (number, node) in self.nodes.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = writeln!(dot, "  n{number} [label=\"{}\"];", self.label(node));
            for (child, label) in [(node.back(), "back"), (node.front(), "front")] {
                if let Some(child) = child {
                    let _ = writeln!(dot, "  n{number} -> n{child} [label=\"{label}\"];");
                }
            }
        }
        dot.push_str("}\n");
        dot
    }
}

impl fmt::Display for PolygonBsp {
    /// A line a node: its side of its parent, its fragments; below it, indented, what is behind, then what is in front.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut stack = Vec::new();
        if !self.nodes.is_empty() {
            stack.push((0, ""));
        }
        while let Some((number, side)) = stack.pop() {
            let node = &self.nodes[number as usize];
            for _ in 0..node.depth().min(MOST_INDENT) {
                f.write_str("  ")?;
            }
            writeln!(f, "{side}{}", self.label(node))?;
            stack.extend(node.front().map(|n| (n, "front ")));
            stack.extend(node.back().map(|n| (n, "back ")));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::accel::bsp::polygon::PolygonBsp;
    use crate::accel::{BspOrder, BuildOptions};
    use crate::geometry::Triangle;
    use glam::Vec3;

    #[test]
    fn pieces_beyond_the_alphabet_have_two_letters() {
        // A floor cut by thirty walls.
        let wall = |i: u32| {
            let x = i as f32 + 0.5;
            let at = |y, z| Vec3::new(x, y, z);
            Triangle::new(at(-9.0, -9.0), at(9.0, -9.0), at(0.0, 9.0))
        };
        let floor = Triangle::new(Vec3::ZERO, Vec3::X * 40.0, Vec3::Y * 2.0);
        let triangles = (0..30).map(wall).chain([floor]).collect();
        let options = BuildOptions {
            order: BspOrder::File,
            ..BuildOptions::default()
        };
        let tree = PolygonBsp::build(triangles, &[], &options);
        let text = tree.to_string();
        // The last piece lies before the last wall: the deepest front.
        assert!(text.ends_with("front 31ae\n"), "{text}");
        assert!(text.contains("back 31a\n") && text.contains("back 31aa\n"));
        assert_eq!(tree.to_dot().matches("shape=box").count(), 1);
        assert_eq!(PolygonBsp::default().to_string(), "");
    }
}
