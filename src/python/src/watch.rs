//! A computation on a thread of its own, whose progress the interpreter sees and which it can stop.

use lugwheel::cli::{self, console::Console};
use pyo3::prelude::*;
use std::io;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Time between two looks at signals and progress.
const LOOK: Duration = Duration::from_millis(50);

/// What a computation has said so far.
#[derive(Debug, Default)]
pub struct Watch {
    results: Mutex<Vec<String>>,
    warnings: Mutex<Vec<String>>,
    progress: Mutex<Option<Progress>>,
    is_stopped: AtomicBool,
}

/// How far a stage of a computation is.
#[derive(Debug, Clone, PartialEq)]
struct Progress {
    stage: String,
    share: f64,
}

impl Watch {
    /// The results, as the command gave them.
    pub fn results(&self) -> Vec<String> {
        taken(&self.results)
    }

    /// The warnings.
    pub fn warnings(&self) -> Vec<String> {
        taken(&self.warnings)
    }

    /// Whether the interpreter has asked the computation to stop.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Does `work` on a thread; `listener` is called with stage and share \[0 to 1\] as they change.
    ///
    /// # Errors
    /// `KeyboardInterrupt` and what other handlers of signals raise; what `listener` raises.
    pub fn over<T: Send>(
        &self,
        py: Python<'_>,
        listener: Option<&Py<PyAny>>,
        work: impl FnOnce() -> T + Send,
    ) -> PyResult<T> {
        let mut raised = None;
        let worked = py.detach(|| {
            let (sender, done) = channel();
            thread::scope(|scope| {
                scope.spawn(move || {
                    // The receiver outlives the thread.
                    let _ = sender.send(work());
                });
                self.listen(&done, listener, &mut raised)
            })
        });
        match (raised, worked) {
            (Some(error), _) => Err(error),
            (None, Some(worked)) => {
                self.tell(py, listener)?;
                Ok(worked)
            }
            (None, None) => Err(pyo3::exceptions::PyRuntimeError::new_err(
                "a computation broke off; this is an error of lugwheel",
            )),
        }
    }

    /// Waits for what the computation sends, listening to the interpreter; none where its thread broke off.
    fn listen<T>(
        &self,
        done: &Receiver<T>,
        listener: Option<&Py<PyAny>>,
        raised: &mut Option<PyErr>,
    ) -> Option<T> {
        loop {
            match done.recv_timeout(LOOK) {
                Ok(worked) => return Some(worked),
                Err(RecvTimeoutError::Disconnected) => return None,
                // Once it is asked to stop, there is only its end to wait for.
                Err(RecvTimeoutError::Timeout) if raised.is_some() => {}
                Err(RecvTimeoutError::Timeout) => {
                    *raised = Python::attach(|py| self.look(py, listener)).err();
                    if raised.is_some() {
                        self.stop();
                    }
                }
            }
        }
    }

    fn look(&self, py: Python<'_>, listener: Option<&Py<PyAny>>) -> PyResult<()> {
        py.check_signals()?;
        self.tell(py, listener)
    }

    fn tell(&self, py: Python<'_>, listener: Option<&Py<PyAny>>) -> PyResult<()> {
        let progress = locked(&self.progress).take();
        if let (Some(listener), Some(Progress { stage, share })) = (listener, progress) {
            listener.call1(py, (stage, share))?;
        }
        Ok(())
    }

    fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
        cli::interrupt_calls();
    }
}

impl Console for Watch {
    fn result(&self, text: &str) -> io::Result<()> {
        locked(&self.results).push(text.to_owned());
        Ok(())
    }

    fn message(&self, _: &str) {}

    fn warning(&self, text: &str) {
        locked(&self.warnings).push(text.to_owned());
    }

    fn progress(&self, name: &str, share: f64) {
        let stage = name.to_owned();
        *locked(&self.progress) = Some(Progress { stage, share });
    }
}

fn taken(texts: &Mutex<Vec<String>>) -> Vec<String> {
    std::mem::take(&mut *locked(texts))
}

/// What a lock holds, also where a thread has panicked with it: all values here are whole at any time.
fn locked<T>(lock: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    lock.lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}
