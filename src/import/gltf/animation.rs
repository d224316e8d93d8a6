//! Animations: what a moment of one makes of the nodes. glTF 2.0 specification, section 3.11.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use serde::Deserialize;
use serde_json::Value;

use super::accessor::Accessor;
use super::document::{Document, Pose, label};
use super::mend::mend;
use super::nodes::local_transform;
use super::notes::Notes;
use super::sampler::{Between, Interpolation, between, mix, mix_rotations};
use crate::import::{ImportError, Moment};

/// Bytes of a value of a keyframe: its index, the element and its numbers in both precisions.
const KEYFRAME_VALUE_BYTES: usize = 64;

/// Names of animations in a message.
const SHOWN_NAMES: usize = 12;

#[derive(Deserialize)]
struct Clip {
    #[serde(default)]
    channels: Vec<Channel>,
    #[serde(default)]
    samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
struct Channel {
    sampler: usize,
    target: Target,
}

#[derive(Deserialize)]
struct Target {
    node: Option<usize>,
    path: String,
}

#[derive(Deserialize)]
struct Sampler {
    input: usize,
    output: usize,
    interpolation: Option<String>,
}

/// What a channel moves, with its value.
enum Change {
    Translation([f64; 3]),
    Rotation([f64; 4]),
    Scale([f64; 3]),
    Weights(Vec<f64>),
}

/// Moves the nodes to `moment`; without one they stay at rest, and a note tells what there is. Files without animations
/// stay as they are.
pub(super) fn pose(
    document: &mut Document,
    moment: Option<Moment>,
    notes: &mut Notes,
) -> Result<(), ImportError> {
    if document.animations.is_empty() {
        return Ok(());
    }
    let Some(moment) = moment else {
        notes.add(
            "animations",
            format!("shown at rest; there are: {}", names(document)),
        );
        return Ok(());
    };
    let index = moment.animation;
    let Some(json) = document.animations.get(index) else {
        let cause = format!("is not there; there are: {}", names(document));
        return Err(document.invalid(format!("animation {index}"), cause));
    };
    let element = label("animation", index, name(json).as_ref());
    let mut json = json.clone();
    let clip: Clip = mend(&mut json)
        .and_then(|()| serde_json::from_value(json).map_err(|e| e.to_string()))
        .map_err(|cause| document.invalid(&element, cause))?;
    let mut end = f64::NEG_INFINITY;
    let mut known_times = HashMap::new();
    for (i, channel) in clip.channels.iter().enumerate() {
        let element = format!("{element}, channel {i}");
        let Some(node) = channel.target.node else {
            notes.add(element, "left out: it moves no node");
            continue;
        };
        let seconds = moment.seconds;
        let change = read_channel(
            document,
            &clip,
            channel,
            node,
            seconds,
            &mut known_times,
            &mut end,
        );
        match change.map_err(|cause| document.invalid(&element, cause))? {
            Some(change) => apply(&mut document.poses[node], change),
            None => notes.add(element, "left out: nothing that it moves is known"),
        }
    }
    if end.is_finite() && moment.seconds > end {
        notes.add(element, format!("ends at {end} s: its end is shown"));
    }
    Ok(())
}

fn name(animation: &Value) -> Option<String> {
    Some(animation.get("name")?.as_str()?.to_owned())
}

fn names(document: &Document) -> String {
    let animations = document.animations.iter().enumerate();
    let mut names: Vec<String> = animations
        .take(SHOWN_NAMES)
        .map(|(i, a)| match name(a) {
            Some(name) => format!("{i} {name:?}"),
            None => i.to_string(),
        })
        .collect();
    let more = document.animations.len() - names.len();
    if more > 0 {
        names.push(format!("{more} more"));
    }
    names.join(", ")
}

/// What a channel makes of its node, `None` where its path is unknown. `end` becomes the time of its last keyframe if that is
/// later. `known_times` keeps the times of samplers, which share them.
fn read_channel(
    document: &Document,
    clip: &Clip,
    channel: &Channel,
    node: usize,
    seconds: f64,
    known_times: &mut HashMap<usize, Vec<f32>>,
    end: &mut f64,
) -> Result<Option<Change>, String> {
    let count = document.root.nodes.len();
    if node >= count {
        return Err(format!("node {node} is not there: the file has {count}"));
    }
    let (index, count) = (channel.sampler, clip.samplers.len());
    let Some(json) = clip.samplers.get(index) else {
        return Err(format!(
            "sampler {index} is not there: the animation has {count}"
        ));
    };
    let in_sampler = |cause: String| format!("sampler {index}: {cause}");
    let width = match channel.target.path.as_str() {
        "translation" | "scale" => 3,
        "rotation" => 4,
        "weights" => 1,
        _ => return Ok(None),
    };
    let Some(interpolation) = Interpolation::of(json.interpolation.as_deref()) else {
        return Err(in_sampler("its interpolation is unknown".to_owned()));
    };
    let times = times(document, json.input, known_times).map_err(in_sampler)?;
    let place = between(times, seconds);
    *end = end.max(times.last().map_or(*end, |&t| f64::from(t)));
    let values = Accessor::open(document, json.output)
        .and_then(|a| a.with_width(width..=width))
        .map_err(in_sampler)?;
    let values = match width {
        3 => values,
        // The format wants integers normalised here.
        _ => values.into_normalized(),
    };
    let keyframes = Keyframes {
        values,
        interpolation,
        count: times.len(),
    };
    let element = || format!("animation, sampler {index}");
    let around = keyframes.around(document, place, element);
    let [first, second] = around.map_err(in_sampler)?;
    let mixed = || mix(interpolation, place, &first, &second);
    let three = |v: Vec<f64>| [v[0], v[1], v[2]];
    let change = match channel.target.path.as_str() {
        "translation" => Change::Translation(three(mixed())),
        "scale" => Change::Scale(three(mixed())),
        "rotation" => match mix_rotations(interpolation, place, &first, &second) {
            Some(rotation) => Change::Rotation(rotation),
            None => return Err(in_sampler("a rotation has no direction".to_owned())),
        },
        _ => Change::Weights(mixed()),
    };
    Ok(Some(change))
}

/// The times of keyframes: at least one, ascending.
fn times<'k>(
    document: &Document,
    index: usize,
    known: &'k mut HashMap<usize, Vec<f32>>,
) -> Result<&'k [f32], String> {
    let known = match known.entry(index) {
        Entry::Occupied(times) => return Ok(times.into_mut()),
        Entry::Vacant(place) => place,
    };
    let accessor = Accessor::open(document, index)?.with_width(1..=1)?;
    let element = || format!("accessor {index}");
    let bytes = size_of::<f32>() + size_of::<u32>();
    document
        .budget
        .charge_many(accessor.count, bytes, element)?;
    let wanted: Vec<u32> = (0..accessor.count as u32).collect();
    let times = accessor.read(&wanted, [0.0]).into_flattened();
    let ascend = times.is_sorted_by(|a, b| a <= b) && times.iter().all(|t| t.is_finite());
    match (times.is_empty(), ascend) {
        (true, _) => Err("has no keyframes".to_owned()),
        (_, false) => Err("the times of its keyframes do not ascend".to_owned()),
        _ => Ok(known.insert(times)),
    }
}

struct Keyframes<'a> {
    values: Accessor<'a>,
    interpolation: Interpolation,
    count: usize,
}

impl Keyframes<'_> {
    /// The rows of the two keyframes of `place`.
    fn around(
        &self,
        document: &Document,
        place: Between,
        element: impl FnOnce() -> String,
    ) -> Result<[Vec<Vec<f64>>; 2], String> {
        let rows = self.count * self.interpolation.rows();
        // One element a row, but for weights, which have one for each morph target.
        let row = match self.values.width() {
            1 => self.values.count / rows,
            _ => 1,
        };
        if row == 0 || self.values.count < rows {
            let found = self.values.count;
            return Err(format!("has {found} values for {rows} rows of keyframes"));
        }
        let bytes = 2 * self.interpolation.rows() * KEYFRAME_VALUE_BYTES;
        document.budget.charge_many(row, bytes, element)?;
        Ok([place.first, place.second].map(|keyframe| self.keyframe(keyframe, row)))
    }

    fn keyframe(&self, keyframe: usize, row: usize) -> Vec<Vec<f64>> {
        let rows = self.interpolation.rows();
        let read = |r: usize| {
            let start = (keyframe * rows + r) * row;
            // Fits: they are places in an accessor, whose count has 32 bits.
            let wanted: Vec<u32> = (start as u32..(start + row) as u32).collect();
            let elements = self.values.read(&wanted, [0.0; 4]);
            let width = self.values.width();
            let numbers = elements.iter().flat_map(|e| &e[..width]);
            numbers.map(|&v| f64::from(v)).collect()
        };
        (0..rows).map(read).collect()
    }
}

/// Moves a node. One with a matrix, which must not be animated, gets the translation, rotation and scale that make it.
fn apply(pose: &mut Pose, change: Change) {
    if !matches!(change, Change::Weights(_)) && pose.matrix.is_some() {
        let (scale, rotation, translation) =
            local_transform(pose, |_| {}).to_scale_rotation_translation();
        pose.matrix = None;
        pose.scale = Some(scale.into());
        pose.rotation = Some(rotation.into());
        pose.translation = Some(translation.into());
    }
    match change {
        Change::Translation(v) => pose.translation = Some(v),
        Change::Rotation(v) => pose.rotation = Some(v),
        Change::Scale(v) => pose.scale = Some(v),
        Change::Weights(v) => pose.weights = Some(v),
    }
}
