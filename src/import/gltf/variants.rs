//! Materials by variant: KHR_materials_variants.

use ::gltf::json::mesh::Primitive;

use super::document::Document;
use super::extensions::Extension;
use super::notes::Notes;
use crate::import::ImportError;

const NAME: &str = "KHR_materials_variants";

/// The names of a file's variants.
pub(super) fn names<'a>(document: &'a Document) -> Vec<&'a str> {
    let root = document.root.extensions.as_ref().map(|e| &e.others);
    let variants = Extension::find(root, NAME).map(|e| e.objects("variants"));
    let name = |v: Option<Extension<'a>>| v.and_then(|v| v.text("name")).unwrap_or_default();
    variants.into_iter().flatten().map(name).collect()
}

/// The index of the variant `wanted`; `None` where none is wanted, and for files without variants. A note tells what there is.
pub(super) fn choose(
    document: &Document,
    wanted: Option<&str>,
    notes: &mut Notes,
) -> Result<Option<usize>, ImportError> {
    let names = names(document);
    if names.is_empty() {
        return Ok(None);
    }
    let list = || {
        let quoted: Vec<String> = names.iter().map(|n| format!("{n:?}")).collect();
        quoted.join(", ")
    };
    let Some(wanted) = wanted else {
        let text = format!("shown with its default materials; there are: {}", list());
        notes.add("variants", text);
        return Ok(None);
    };
    match names.iter().position(|n| *n == wanted) {
        Some(index) => Ok(Some(index)),
        None => {
            let cause = format!("is not there; there are: {}", list());
            Err(document.invalid(format!("variant {wanted:?}"), cause))
        }
    }
}

/// The material that a primitive has in a variant, if that is another than its own.
pub(super) fn material(json: &Primitive, variant: usize) -> Option<usize> {
    let extension = Extension::find(json.extensions.as_ref().map(|e| &e.others), NAME)?;
    let mappings = extension.objects("mappings").into_iter().flatten();
    let mut of_variant = mappings.filter(|m| m.lists("variants", variant));
    of_variant.find_map(|m| m.index("material"))
}
