//! How probable each explanation is to the diagnoses of several campaigns, as a bar a campaign.

use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, MUTED, PALETTE, Panel};

/// Width of the drawing [px].
const WIDTH: f64 = 1100.0;
/// Room left of the bars for names [px].
const LEFT: f64 = 380.0;
/// Room right of the bars for answers [px].
const RIGHT: f64 = 270.0;
/// Room above the bars for title and legend [px].
const TOP: f64 = 84.0;
/// Height of a bar with its distance to the next [px].
const PITCH: f64 = 30.0;
/// Campaigns shown; what comes behind is left out.
const SHOWN: usize = 40;

/// What a part of a bar stands for, in its order, and its colour.
const PARTS: [(&str, &str); 6] = [
    ("true cause", PALETTE[0]),
    ("other effects", PALETTE[1]),
    ("parameters", PALETTE[2]),
    ("none", PALETTE[4]),
    ("unknown cause", PALETTE[5]),
    ("undecided", "#b9c0cc"),
];

/// A campaign and the probabilities of what explains it.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignBar {
    /// Which campaign.
    pub name: String,
    /// Probabilities [-] of the truth, other effects, parameters, nothing, the unknown, and undecided;
    /// none without an answer. What the truth has, the others have not.
    pub probabilities: Option<[f64; 6]>,
    /// The answer in a few words.
    pub answer: String,
    /// Whether the answer is the truth.
    pub is_right: bool,
}

/// Probabilities of the truth and of all else, a bar a campaign, the first forty of them; the answer at the
/// right, bold where it is the truth. One SVG 1100 px wide.
pub fn campaign_bars(bars: &[CampaignBar], title: &str) -> String {
    let shown = bars.len().min(SHOWN);
    let rows = shown.max(1) as f64;
    let area = Area {
        left: LEFT,
        top: TOP,
        width: WIDTH - LEFT - RIGHT,
        height: PITCH * rows,
    };
    let mut canvas = Canvas::new([WIDTH, area.bottom() + Panel::FOOTER + 8.0], title);
    let text = Font::TITLE.fit(title, WIDTH - 32.0);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, &text);
    draw_legend(&mut canvas);
    let panel = Panel {
        area,
        x: Axis::exact([0.0, 1.0], [area.left, area.right()]),
        y: Axis::exact([rows, 0.0], [area.bottom(), area.top]),
    };
    panel.draw_tenths(&mut canvas);
    for (place, bar) in bars.iter().take(shown).enumerate() {
        draw_bar(&mut canvas, &panel, place as f64, bar);
    }
    panel.draw_footer(&mut canvas, "probability [-]");
    canvas.finish()
}

fn draw_legend(canvas: &mut Canvas) {
    let mut left = 16.0;
    for (name, colour) in PARTS {
        let swatch = Area {
            left,
            top: 50.0,
            width: 14.0,
            height: 14.0,
        };
        canvas.rect(&swatch, colour, name);
        canvas.text([left + 20.0, 62.0], Anchor::Start, Font::SMALL, name);
        left += 44.0 + Font::SMALL.width(name);
    }
}

fn draw_bar(canvas: &mut Canvas, panel: &Panel, place: f64, bar: &CampaignBar) {
    let y = panel.area.top + (place + 0.5) * PITCH;
    let mut from = 0.0;
    let probabilities = bar.probabilities.unwrap_or_default();
    for ((name, colour), probability) in PARTS.into_iter().zip(probabilities) {
        let to = (from + probability).clamp(0.0, 1.0);
        let [left, right] = [from, to].map(|share| panel.x.pixel(share));
        if right > left {
            let part = Area {
                left,
                top: y - 0.36 * PITCH,
                width: right - left,
                height: 0.72 * PITCH,
            };
            let tip = format!("{name}: {:.1} %", 100.0 * probability);
            canvas.rect(&part, colour, &tip);
        }
        from = to;
    }
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let text = font.fit(&bar.name, LEFT - 28.0);
    let at = [panel.area.left - 10.0, y + 5.0];
    canvas.text(at, Anchor::End, font, &text);
    let font = Font {
        colour: if bar.is_right { INK } else { MUTED },
        bold: bar.is_right,
        ..Font::SMALL
    };
    let text = font.fit(&bar.answer, RIGHT - 28.0);
    let at = [panel.area.right() + 12.0, y + 5.0];
    canvas.text(at, Anchor::Start, font, &text);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(probabilities: Option<[f64; 6]>) -> CampaignBar {
        CampaignBar {
            name: "slip_sinkage = 0.4".to_owned(),
            probabilities,
            answer: "slip_sinkage".to_owned(),
            is_right: true,
        }
    }

    #[test]
    fn a_bar_shows_what_has_a_share_and_a_campaign_without_an_answer_none() {
        let known = bar(Some([0.75, 0.0, 0.25, 0.0, 0.0, 0.0]));
        let figure = campaign_bars(&[known, bar(None)], "power");
        let parts = figure.matches(" %<").count();
        // Two parts; the ticks of the axis have no per cent.
        assert_eq!(parts, 2, "{figure}");
        assert!(figure.contains("true cause: 75.0 %"));
        assert_eq!(figure.matches(">slip_sinkage = 0.4<").count(), 2);
    }

    #[test]
    fn no_campaigns_make_an_empty_drawing() {
        assert!(campaign_bars(&[], "power").starts_with("<svg"));
    }
}
