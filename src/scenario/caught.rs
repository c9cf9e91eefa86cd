//! A run that panics fails like any other.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What `run` returns; if it panics, the error which `failed` makes of the message.
///
/// # Errors
/// Those of `run`, and that of `failed`.
pub(crate) fn caught<T, E>(
    run: impl FnOnce() -> Result<T, E>,
    failed: impl FnOnce(String) -> E,
) -> Result<T, E> {
    catch_unwind(AssertUnwindSafe(run))
        .unwrap_or_else(|panic| Err(failed(format!("it panicked: {}", message(&*panic)))))
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_panics_fails_with_the_message_of_the_panic() {
        let run = || -> Result<(), String> { panic!("no ground at {} m", 1.5) };
        assert_eq!(
            caught(run, |reason| reason),
            Err("it panicked: no ground at 1.5 m".to_owned())
        );
        assert_eq!(caught(|| Ok::<_, String>(7), |reason| reason), Ok(7));
    }
}
