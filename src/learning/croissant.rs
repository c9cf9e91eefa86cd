//! The metadata of a data set as Croissant 1.0, a JSON-LD that data set searches and loaders read
//! (<https://docs.mlcommons.org/croissant/docs/croissant-spec.html>).
//!
//! `url` and `datePublished`, which the specification wants, are facts of a publication and are left
//! to whoever publishes.

use super::splits::PARTS;
use super::{DataSet, FileFact, Kept};
use crate::dataset::records::{Field, Kind, Records};
use crate::quantity::hexadecimal;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::Path;

impl DataSet {
    /// The metadata as JSON; `texts` are the other files beside that of the runs.
    pub(super) fn croissant(&self, file: &FileFact, texts: &[(&'static str, String)]) -> String {
        let stem = Path::new(&file.name).file_stem().unwrap_or_default();
        let stem = &*stem.to_string_lossy();
        let what = match self.facts.kept {
            Kept::Traces => {
                "Simulated runs of a lugged wheel on hard, gravel and sandy ground: \
                             accelerations, forces, sinkage and slip, the class of every window."
            }
            Kept::Features => {
                "Vibration features of simulated runs of a lugged wheel on hard, gravel \
                               and sandy ground, and the class of every window."
            }
        };
        let mut distribution = vec![json!({
            "@type": "cr:FileObject",
            "@id": file.name,
            "name": file.name,
            "contentUrl": file.name,
            "contentSize": format!("{} B", file.bytes),
            "encodingFormat": "application/x-hdf5",
            "sha256": file.sha256,
        })];
        distribution.extend(
            texts
                .iter()
                .map(|(ending, text)| text_file(stem, ending, text)),
        );
        let document = json!({
            "@context": context(),
            "@type": "sc:Dataset",
            "conformsTo": "http://mlcommons.org/croissant/1.0",
            "name": stem,
            "description": what,
            "license": "https://spdx.org/licenses/MIT.html",
            "version": "1.0.0",
            "creator": {"@type": "sc:Organization", "name": self.facts.created_by},
            "citeAs": format!("{}, `{}`", self.facts.created_by, self.facts.command),
            "keywords": ["terramechanics", "vibration", "planetary rover", "terrain classification"],
            "distribution": distribution,
            "recordSet": [
                parts(),
                record_set("runs", "One record a run and its part in every split.", &self.splits(), &format!("{stem}.splits.csv")),
                record_set("windows", "One record a window: class, features, parts.", &self.windows, &format!("{stem}.windows.csv")),
            ],
        });
        format!("{document:#}\n")
    }
}

fn text_file(stem: &str, ending: &str, text: &str) -> Value {
    let name = format!("{stem}.{ending}");
    let format = if ending.ends_with(".md") {
        "text/markdown"
    } else {
        "text/csv"
    };
    json!({
        "@type": "cr:FileObject",
        "@id": name,
        "name": name,
        "contentUrl": name,
        "contentSize": format!("{} B", text.len()),
        "encodingFormat": format,
        "sha256": hexadecimal(&Sha256::digest(text)),
    })
}

/// The enumeration of the parts, tied to Croissant's own words for them.
fn parts() -> Value {
    let data = PARTS
        .iter()
        .zip(["cr:TrainingSplit", "cr:ValidationSplit", "cr:TestSplit"]);
    let data = data.map(|((part, _), url)| json!({"parts/name": part.as_str(), "parts/url": url}));
    json!({
        "@type": "cr:RecordSet",
        "@id": "parts",
        "name": "parts",
        "description": "The parts of the splits.",
        "dataType": "cr:Split",
        "key": {"@id": "parts/name"},
        "field": [
            {"@type": "cr:Field", "@id": "parts/name", "name": "name", "dataType": "sc:Text"},
            {"@type": "cr:Field", "@id": "parts/url", "name": "url", "dataType": ["sc:URL", "cr:Split"]},
        ],
        "data": data.collect::<Vec<Value>>(),
    })
}

fn record_set(id: &str, description: &str, records: &Records, file: &str) -> Value {
    let fields = records.fields.iter().map(|field| field_of(id, field, file));
    json!({
        "@type": "cr:RecordSet",
        "@id": id,
        "name": id,
        "description": description,
        "field": fields.collect::<Vec<Value>>(),
    })
}

fn field_of(id: &str, field: &Field, file: &str) -> Value {
    let Field {
        name,
        unit,
        kind,
        meaning,
    } = field;
    let description = match *unit {
        "" | "1" => (*meaning).to_owned(),
        unit => format!("{meaning} [{unit}]"),
    };
    json!({
        "@type": "cr:Field",
        "@id": format!("{id}/{name}"),
        "name": name,
        "description": description,
        "dataType": match kind {
            Kind::Whole => "sc:Integer",
            Kind::Number => "sc:Float",
            Kind::Text => "sc:Text",
        },
        "source": {"fileObject": {"@id": file}, "extract": {"column": name}},
    })
}

/// The words of Croissant 1.0, as its specification lists them.
fn context() -> Value {
    json!({
        "@language": "en",
        "@vocab": "https://schema.org/",
        "citeAs": "cr:citeAs",
        "column": "cr:column",
        "conformsTo": "dct:conformsTo",
        "cr": "http://mlcommons.org/croissant/",
        "data": {"@id": "cr:data", "@type": "@json"},
        "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
        "dct": "http://purl.org/dc/terms/",
        "equivalentProperty": "cr:equivalentProperty",
        "examples": {"@id": "cr:examples", "@type": "@json"},
        "extract": "cr:extract",
        "field": "cr:field",
        "fileObject": "cr:fileObject",
        "fileProperty": "cr:fileProperty",
        "fileSet": "cr:fileSet",
        "format": "cr:format",
        "includes": "cr:includes",
        "isLiveDataset": "cr:isLiveDataset",
        "jsonPath": "cr:jsonPath",
        "key": "cr:key",
        "md5": "cr:md5",
        "parentField": "cr:parentField",
        "path": "cr:path",
        "rai": "http://mlcommons.org/croissant/RAI/",
        "recordSet": "cr:recordSet",
        "references": "cr:references",
        "regex": "cr:regex",
        "repeated": "cr:repeated",
        "replace": "cr:replace",
        "samplingRate": "cr:samplingRate",
        "sc": "https://schema.org/",
        "separator": "cr:separator",
        "source": "cr:source",
        "subField": "cr:subField",
        "transform": "cr:transform",
    })
}
