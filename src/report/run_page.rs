//! The page of a run: wheel and ground as they moved, channels to zoom, and the drawing of both.

use super::figure::Layout;
use super::page::{Figure, Page, Provenance, Section};
use super::run_view::RunView;
use super::run_words::{origin, terrain_name, wheel_and_condition};
use super::{ReportError, laid_out_trace_figure};
use crate::trace::Trace;

/// The page of the run `id`. A run of means alone has its drawing only.
///
/// # Errors
/// `Empty` when there is nothing to draw.
pub fn run_page(trace: &Trace, id: &str, provenance: Provenance) -> Result<Page, ReportError> {
    let run = &trace.attributes;
    let terrain = run.terrain.map_or("terrain not given", terrain_name);
    let view = RunView::new(trace, id).ok();
    let moving = view.map(|view| Section::new("Wheel, ground and channels").run(view));
    let draw = |layout| laid_out_trace_figure(trace, id, layout);
    let drawing = Figure::new(
        draw(Layout::SCREEN)?,
        "The wheel in the middle of the run, to scale; channels over time; the order spectrum.",
    )
    .narrow(draw(Layout::TELEPHONE)?);
    let drawing = Section::new("The run as one drawing").figure(drawing);
    Ok(Page {
        title: format!("Run {id}: {terrain}"),
        intro: format!("{}\n\n{}", wheel_and_condition(run), origin(run)),
        sections: moving.into_iter().chain([drawing]).collect(),
        provenance,
        ..Page::default()
    })
}
