//! Filters one after the other, block by block.

/// One filter of a chain.
pub(super) trait Stage {
    /// Takes samples and appends the outputs that they complete to `out`.
    fn push(&mut self, block: &[f64], out: &mut Vec<f64>);

    /// Appends the remaining outputs.
    fn finish(&mut self, out: &mut Vec<f64>);
}

/// A chain of filters.
pub(super) struct Stages<S> {
    stages: Vec<S>,
    /// The first sample: filters operate on differences from it, so that a constant passes exactly.
    reference: Option<f64>,
    ping: Vec<f64>,
    pong: Vec<f64>,
}

impl<S: Stage> Stages<S> {
    pub fn new(stages: Vec<S>) -> Self {
        Self {
            stages,
            reference: None,
            ping: Vec::new(),
            pong: Vec::new(),
        }
    }

    /// Takes samples and appends the outputs that they complete to `out`.
    pub fn push(&mut self, block: &[f64], out: &mut Vec<f64>) {
        let Some(&first) = block.first() else { return };
        let reference = *self.reference.get_or_insert(first);
        self.ping.clear();
        self.ping.extend(block.iter().map(|x| x - reference));
        for stage in &mut self.stages {
            self.pong.clear();
            stage.push(&self.ping, &mut self.pong);
            std::mem::swap(&mut self.ping, &mut self.pong);
        }
        out.extend(self.ping.iter().map(|x| x + reference));
    }

    /// Appends the remaining outputs.
    pub fn finish(self, out: &mut Vec<f64>) {
        let Some(reference) = self.reference else {
            return;
        };
        let mut rest = Vec::new();
        for mut stage in self.stages {
            let mut next = Vec::new();
            stage.push(&rest, &mut next);
            stage.finish(&mut next);
            rest = next;
        }
        out.extend(rest.iter().map(|x| x + reference));
    }
}
