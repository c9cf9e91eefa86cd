//! How far a computation is, on a terminal.

use super::console::Attached;
use super::output::Output;
use clap::builder::styling::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::time::{Duration, Instant};

/// How the word `warning` looks; plain where stderr is no terminal or `NO_COLOR` is set.
const WARNING: Style = AnsiColor::Yellow.on_default().bold();

/// What takes less needs no bar.
const PATIENCE: Duration = Duration::from_secs(2);

/// Positions of the bar in a simulated second.
const FINENESS: f64 = 1.0e3;

const TEMPLATE: &str = "{msg} [{bar:30}] {percent:>3} %, {speed}, {eta} left";

/// A bar on stderr over the simulated time, with speed and time left; hidden for the first
/// seconds, where stderr is no terminal, and with `--quiet`; a calling program receives the share instead. It
/// goes away when dropped.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    name: String,
    begun: Instant,
    is_quiet: bool,
    console: Attached,
    shown: Once,
    next: Once,
    /// What the bar is over, where its work has several stages.
    stage: Mutex<Option<Stage>>,
}

/// A part of a work: what it fills of the bar, and how much of it is done.
#[derive(Debug)]
struct Stage {
    /// Share of the bar [-] at its beginning and end.
    span: [f64; 2],
    /// Done and total, in the same unit.
    done: f64,
    total: f64,
}

impl Stage {
    /// Share of the bar [-] that is filled.
    fn share(&self) -> f64 {
        let [from, to] = self.span;
        let part = if self.total > 0.0 {
            self.done / self.total
        } else {
            0.0
        };
        from + part.min(1.0) * (to - from)
    }
}

impl Progress {
    /// A bar over `simulated` [s] named `name`.
    pub fn new(output: &Output, name: &str, simulated: f64) -> Self {
        Self::with_style(output, name, simulated, style())
    }

    /// A bar over `runs`; each advances it by 1.
    pub fn of_runs(output: &Output, name: &str, runs: usize) -> Self {
        Self::with_style(output, name, runs as f64, style_of_runs())
    }

    fn with_style(output: &Output, name: &str, total: f64, style: ProgressStyle) -> Self {
        let length = (total * FINENESS) as u64;
        let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::hidden())
            .with_style(style)
            .with_message(name.to_owned());
        Self {
            bar,
            name: name.to_owned(),
            begun: Instant::now(),
            is_quiet: output.quiet,
            console: output.console.clone(),
            shown: Once::new(),
            next: Once::new(),
            stage: Mutex::new(None),
        }
    }

    /// A bar over a work of several stages, each of which [`begin`](Self::begin)s.
    pub fn of_stages(output: &Output, name: &str) -> Self {
        Self::with_style(output, name, 1.0, style_of_runs())
    }

    /// Begins a stage of `total` [s of simulated time, or runs], which fills the bar over this span of shares [-].
    pub fn begin(&self, name: &str, span: [f64; 2], total: f64) {
        self.add_to_name(name);
        *self.locked_stage() = Some(Stage {
            span,
            done: 0.0,
            total,
        });
    }

    fn locked_stage(&self) -> MutexGuard<'_, Option<Stage>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the stage and shows it; whether there is one. The bar does not go back where a stage has parts.
    fn in_stage(&self, change: impl FnOnce(&mut Stage)) -> bool {
        let mut stage = self.locked_stage();
        let Some(stage) = stage.as_mut() else {
            return false;
        };
        change(stage);
        let position = (stage.share() * FINENESS) as u64;
        self.bar.set_position(position.max(self.bar.position()));
        self.show();
        true
    }

    /// `simulated` [s] more are done.
    pub fn advance(&self, simulated: f64) {
        if !self.in_stage(|stage| stage.done += simulated) {
            self.bar.inc((simulated * FINENESS) as u64);
            self.show();
        }
    }

    /// This share of all is done.
    pub fn set_share(&self, share: f64) {
        let length = self.bar.length().unwrap_or_default();
        self.bar.set_position((share * length as f64) as u64);
        self.show();
    }

    /// Adds text behind the name.
    pub fn add_to_name(&self, more: &str) {
        self.bar.set_message(format!("{}, {more}", self.name));
    }

    /// Prints a line above the bar, unless `--quiet`.
    pub fn print(&self, text: &str) {
        match self.console.caller() {
            Some(console) => console.message(text),
            None if self.is_quiet => {}
            None => self.bar.suspend(|| eprintln!("{text}")),
        }
    }

    /// Warns of something above the bar.
    pub fn warn(&self, text: &str) {
        match self.console.caller() {
            Some(console) => console.warning(text),
            None => self
                .bar
                .suspend(|| anstream::eprintln!("{WARNING}warning:{WARNING:#} {text}")),
        }
    }

    fn show(&self) {
        if let Some(console) = self.console.caller() {
            let length = self.bar.length().unwrap_or_default().max(1);
            let share = self.bar.position() as f64 / length as f64;
            return console.progress(&self.bar.message(), share.min(1.0));
        }
        if !self.is_quiet && self.begun.elapsed() > PATIENCE {
            self.shown
                .call_once(|| self.bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
    }

    /// `done` of `total` runs are done; both may change on the way.
    pub fn reach(&self, done: u64, total: u64) {
        let length = total as f64 * FINENESS;
        if self.bar.length() != Some(length as u64) {
            self.bar.set_length(length as u64);
            self.bar.reset_eta();
        }
        self.bar.set_position((done as f64 * FINENESS) as u64);
        self.advance(0.0);
    }

    /// As [`reach_next`](Self::reach_next) of a bar of one stage; in a stage of several, `done` of `total` are done of
    /// the part between these shares [-] of it.
    pub fn reach_part(&self, name: &str, [from, to]: [f64; 2], done: u64, total: u64) {
        let part = done as f64 / total.max(1) as f64;
        let in_stage = self.in_stage(|stage| {
            stage.done = from + part * (to - from);
            stage.total = 1.0;
        });
        if in_stage {
            self.add_to_name(name);
        } else {
            self.reach_next(name, done, total);
        }
    }

    /// As [`reach`](Self::reach) in the next stage, named `name`, when what the bar was made for
    /// is done.
    pub fn reach_next(&self, name: &str, done: u64, total: u64) {
        self.next.call_once(|| self.bar.set_style(style_of_runs()));
        self.add_to_name(name);
        self.reach(done, total);
    }

    /// Time [s] since the start.
    pub fn elapsed(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

fn style_of_runs() -> ProgressStyle {
    ProgressStyle::with_template("{msg} [{bar:30}] {percent:>3} %, {eta} left")
        .expect("the template is part of the program")
        .progress_chars("=> ")
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template(TEMPLATE)
        .expect("the template is part of the program")
        .progress_chars("=> ")
        .with_key("speed", |state: &ProgressState, text: &mut dyn Write| {
            let _ = write!(text, "{:.2} x real time", state.per_sec() / FINENESS);
        })
}
