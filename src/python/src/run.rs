//! One run: its channels as arrays, its attributes and its ground truth.

use lugwheel::trace::wheel::Plate;
use lugwheel::trace::{ClassWindow, Contact, RunAttributes, Trace, Truth};
use numpy::ndarray::ArrayView1;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// A run, simulated or measured. It never changes.
#[pyclass(frozen, module = "lugwheel._native")]
pub struct Run(pub Trace);

#[pymethods]
impl Run {
    /// Names of its channels.
    #[getter]
    fn channels(&self) -> Vec<&str> {
        let channels = self.0.channels.iter();
        channels.map(|channel| channel.name.as_str()).collect()
    }

    /// Unit, sample rate \[Hz\] and time of the first sample \[s\] of a channel.
    fn description(&self, name: &str) -> Option<(&str, f64, f64)> {
        let channel = self.0.channel(name)?;
        Some((&channel.unit, channel.sample_rate, channel.start))
    }

    /// The samples of a channel: a read-only view of this run.
    fn samples<'py>(
        slf: &Bound<'py, Self>,
        name: &str,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let Some(channel) = slf.get().0.channel(name) else {
            return Ok(None);
        };
        let view = ArrayView1::from(&channel.samples);
        // SAFETY: the array keeps the run alive, whose samples are never changed nor moved; it is made read-only
        // before anybody sees it.
        let array = unsafe { PyArray1::borrow_from_array(&view, slf.clone().into_any()) };
        array.try_readwrite()?.make_nonwriteable();
        Ok(Some(array))
    }

    /// Mean \[unit of the channel\] over the middle half, or the mean that was measured.
    fn steady_mean(&self, name: &str) -> Option<f64> {
        self.0.steady_mean(name)
    }

    /// Whether that mean is steady: `steady`, `drifting` or `too_short`.
    fn steadiness(&self, name: &str) -> Option<&'static str> {
        Some(self.0.steadiness(name)?.name())
    }

    /// Steady values without a time series: name to value, unit, standard deviation and number of samples.
    #[getter]
    fn means<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let means = PyDict::new(py);
        for mean in &self.0.means {
            means.set_item(&mean.name, (mean.value, &mean.unit, mean.sd, mean.n))?;
        }
        Ok(means)
    }

    /// Wheel, condition and label, by the names of run files.
    #[getter]
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        attributes(py, &self.0.attributes)
    }

    /// What a simulation knows and no sensor measures.
    #[getter]
    fn truth<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.0
            .truth
            .as_ref()
            .map(|known| truth(py, known))
            .transpose()
    }
}

fn attributes<'py>(py: Python<'py>, run: &RunAttributes) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("wheel_radius_m", run.wheel_radius)?;
    found.set_item("wheel_width_m", run.wheel_width)?;
    found.set_item("lug_count", run.lug_count)?;
    found.set_item("lug_height_m", run.lug_height)?;
    found.set_item("lug_thickness_m", run.lug_thickness)?;
    found.set_item("wheel_mass_kg", run.wheel_mass)?;
    found.set_item("slope_deg", run.slope_deg)?;
    found.set_item("load_n", run.load)?;
    found.set_item("speed_m_s", run.speed)?;
    found.set_item("slip_ratio", run.slip_ratio)?;
    found.set_item("terrain", run.terrain.map(|terrain| terrain.as_str()))?;
    found.set_item("class", run.class.map(|class| class.as_str()))?;
    found.set_item("repeat", run.repeat)?;
    found.set_item("day", &run.day)?;
    found.set_item("notes", &run.notes)?;
    found.set_item("physics_rate_hz", run.physics_rate)?;
    found.set_item("import_notes", &run.import_notes)?;
    found.set_item("wheel_angle_zero_known", !run.angle_zero_unknown)?;
    match run.plate {
        None => {}
        Some(Plate::Disc { diameter }) => found.set_item("plate_diameter_m", diameter)?,
        Some(Plate::Rectangle { length, width }) => {
            found.set_item("plate_length_m", length)?;
            found.set_item("plate_width_m", width)?;
        }
    }
    Ok(found)
}

fn truth<'py>(py: Python<'py>, known: &Truth) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("contacts", contacts(py, &known.contacts)?)?;
    let windows = known.class_windows.iter();
    let windows: Vec<_> = windows
        .map(|window| class_window(py, window))
        .collect::<PyResult<_>>()?;
    found.set_item("class_windows", PyList::new(py, windows)?)?;
    found.set_item("parameters", &known.parameters)?;
    let axis = |of: usize| PyArray1::from_iter(py, known.profile.iter().map(|point| point[of]));
    let profile = PyDict::new(py);
    profile.set_item("x", axis(0))?;
    profile.set_item("height", axis(1))?;
    found.set_item("profile", profile)?;
    found.set_item("carriage_at_limit", known.at_limit.carriage)?;
    found.set_item("motor_at_limit", known.at_limit.motor)?;
    Ok(found)
}

fn contacts<'py>(py: Python<'py>, contacts: &[Contact]) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item(
        "lug",
        PyArray1::from_iter(py, contacts.iter().map(|contact| contact.lug)),
    )?;
    found.set_item(
        "start_s",
        PyArray1::from_iter(py, contacts.iter().map(|contact| contact.start)),
    )?;
    found.set_item(
        "end_s",
        PyArray1::from_iter(py, contacts.iter().map(|contact| contact.end)),
    )?;
    found.set_item(
        "entered",
        PyArray1::from_iter(py, contacts.iter().map(|contact| contact.entered)),
    )?;
    Ok(found)
}

fn class_window<'py>(py: Python<'py>, window: &ClassWindow) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("start_s", window.start)?;
    found.set_item("end_s", window.end)?;
    found.set_item("class", window.class.as_str())?;
    found.set_item("terrain", window.terrain.as_str())?;
    if let Some(lugs) = window.lugs {
        found.set_item("lugs_passed", lugs.passed)?;
        found.set_item("lugs_touched", lugs.touched)?;
        found.set_item("lugs_entered", lugs.entered)?;
    }
    Ok(found)
}
