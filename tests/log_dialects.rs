//! Logs as LabVIEW, MATLAB, pandas, ROS, R, spreadsheets and Arduino boards write them: what gets in as it is,
//! and for the rest a message whose way out works.

use crate::logs::{Logs, channel, noted, says, table};
use std::f64::consts::TAU;

const COLUMNS: &str = "columns = { time_s = \"t\", normal_force = \"Fz\" }\n";
const ROWS: u32 = 40;

fn time(i: u32) -> f64 {
    0.01 * f64::from(i)
}

fn force(i: u32) -> f64 {
    100.0 + f64::from(i % 7) + 0.5
}

/// Forty rows at 100 Hz below these lines.
fn log(lead: &str, row: impl Fn(u32) -> String) -> String {
    table("", ROWS, row).replacen('\n', lead, 1)
}

/// Expects the forty forces at 100 Hz, to `tolerance` [Hz].
fn is_whole(logs: &Logs, run: &str) {
    let trace = logs.run(run);
    let force_ = channel(&trace, "normal_force");
    assert!(
        (force_.sample_rate - 100.0).abs() < 0.01,
        "{run}: {}",
        force_.sample_rate
    );
    let expected: Vec<f64> = (0..ROWS).map(force).collect();
    assert_eq!(force_.samples, expected, "{run}");
}

const LABVIEW: &str = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tOne\n\
     Date\t2024/05/03\nTime\t10:00:00,123\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t40\t40\t\n\
     Y_Unit_Label\tNewton\tMeter\t\nX_Dimension\tTime\tTime\t\nX0\t0,0E+0\t0,0E+0\t\nDelta_X\t0,010000\t0,010000\t\n\
     ***End_of_Header***\t\t\t\nX_Value\tFz\tz\tComment\n";

#[test]
fn the_preamble_of_a_labview_file_and_its_comment_without_cells_have_ways_out_that_work() {
    let row = |i| format!("{:.6}\t{:.6}\t0.001", time(i), force(i)).replace('.', ",");
    let text = log(LABVIEW, row);
    // With the line ends of Windows, which LabVIEW writes, and with others.
    for text in [
        text.replace('\n', "\r\n"),
        text.clone(),
        text.replace('\n', "\r"),
    ] {
        let logs = Logs::new().with("a.lvm", text);
        let labview = "file = \"a.lvm\"\ndelimiter = \"\\t\"\n";
        let columns = "columns = { time_s = \"X_Value\", normal_force = \"Fz\" }\n";
        says(
            &logs.refused(&format!("{labview}{columns}")),
            &["line 17 has it: write skip_lines = 16"],
        );
        let skipped = format!("{labview}skip_lines = 16\n");
        says(
            &logs.refused(&format!("{skipped}{columns}")),
            &[
                "a.lvm:18: 3 cells in this row, 4 in the header",
                "header_rows = 1 and names = [...]",
            ],
        );
        let named = "header_rows = 1\nnames = [\"t\", \"Fz\", \"z\"]\n";
        is_whole(&logs, &format!("{skipped}{named}{COLUMNS}"));
    }
}

#[test]
fn names_below_other_lines_are_found_with_the_lines_to_skip() {
    let plain = |i| format!("{:.2},{}", time(i), force(i));
    for (name, lead, skip, columns) in [
        ("a comment of MATLAB", "% rig 3\n% t,Fz\n", 1, COLUMNS),
        (
            "the delimiter that Excel is told",
            "sep=,\nt,Fz\n",
            1,
            COLUMNS,
        ),
        (
            "two rows of names of pandas",
            "imu,force\nt,Fz\n",
            1,
            COLUMNS,
        ),
        (
            "markers of Vicon",
            "Trajectories\n100\n,rover:wheel\nFrame,Z\n,mm\n",
            3,
            "sample_rate_hz = 100\ncolumns = { sinkage = { column = \"Z\", unit = \"mm\" } }\n",
        ),
        (
            "a session of PuTTY",
            "=~=~=~= PuTTY log 2024.05.03 10:00:00 =~=~=~=\nboot\nt,Fz\n",
            2,
            COLUMNS,
        ),
    ] {
        let logs = Logs::new().with("a.csv", log(lead, plain));
        let way_out = format!("skip_lines = {skip}");
        let refused = logs.refused(&format!("file = \"a.csv\"\n{columns}"));
        assert!(refused.ends_with(&way_out), "{name}: {refused}");
        let trace = logs.run(&format!("file = \"a.csv\"\n{way_out}\n{columns}"));
        assert_eq!(trace.channels[0].samples.len(), ROWS as usize, "{name}");
    }
}

#[test]
fn tables_of_pandas_r_and_gnuplot_get_in() {
    let plain = |i| format!("{:.2},{}", time(i), force(i));
    let cases: [(&str, String, &str); 7] = [
        (
            "an index",
            log(",t,Fz\n", |i| format!("{i},{}", plain(i))),
            "",
        ),
        (
            "blanks after commas",
            log("t, Fz\n", |i| plain(i).replace(',', ", ")),
            "",
        ),
        (
            "truths beside numbers",
            log("t,Fz,ok\n", |i| plain(i) + ",True"),
            "",
        ),
        (
            "tabs behind #",
            log("#t\tFz\n", |i| plain(i).replace(',', "\t")),
            "delimiter = \"\\t\"\n",
        ),
        (
            "rows named by R",
            log("\"t\" \"Fz\"\n", |i| {
                format!("\"{i}\" {}", plain(i).replace(',', " "))
            }),
            "delimiter = \" \"\nheader_rows = 1\nnames = [\"row\", \"t\", \"Fz\"]\n",
        ),
        (
            "line ends written twice on Windows",
            log("t,Fz\n", plain).replace('\n', "\r\r\n"),
            "",
        ),
        (
            "no end of the last line",
            log("t,Fz\n", plain).trim_end().to_owned(),
            "",
        ),
    ];
    for (name, text, layout) in cases {
        let logs = Logs::new().with("a.csv", text);
        println!("{name}");
        is_whole(&logs, &format!("file = \"a.csv\"\n{layout}{COLUMNS}"));
    }
}

#[test]
fn clocks_of_python_spreadsheets_and_boards_make_the_same_rate() {
    // Python leaves the microseconds out where they are 0.
    let python = |i: u32| match i {
        0 => String::new(),
        i => format!(".{:06}", 10_000 * i),
    };
    type Stamp<'a> = Box<dyn Fn(u32) -> String + 'a>;
    let cases: [(&str, Stamp<'_>, &str); 8] = [
        (
            "str(datetime)",
            Box::new(|i| format!("2024-05-03 10:00:00{}", python(i))),
            "\"t\"",
        ),
        (
            "str(timedelta)",
            Box::new(|i| format!("0:00:00{}", python(i))),
            "\"t\"",
        ),
        (
            "pandas.Timedelta",
            Box::new(|i| format!("0 days 00:00:00{}", python(i))),
            "\"t\"",
        ),
        (
            "isoformat() with a zone",
            Box::new(|i| format!("2024-05-03T10:00:00{}+02:00", python(i))),
            "\"t\"",
        ),
        (
            "a German date with a decimal comma",
            Box::new(|i| format!("03.05.2024 10:00:00,{:03}", 10 * i)),
            "{ column = \"t\", format = \"%d.%m.%Y %H:%M:%S%.f\" }",
        ),
        (
            "an American date",
            Box::new(|i| format!("05/03/2024 10:00:00.{:03}", 10 * i)),
            "{ column = \"t\", format = \"%m/%d/%Y %H:%M:%S%.f\" }",
        ),
        (
            "days of a spreadsheet",
            Box::new(|i| format!("{:.10}", 45_415.416_666_666_7 + time(i) / 86_400.0)),
            "{ column = \"t\", unit = \"d\" }",
        ),
        (
            "micros() past its 32 bits",
            Box::new(|i| 4_294_900_000_u32.wrapping_add(10_000 * i).to_string()),
            "{ column = \"t\", unit = \"us\", wraps_at = 4294967296 }",
        ),
    ];
    for (name, stamp, time) in cases {
        let text = log("t;Fz\n", |i| format!("{};{}", stamp(i), force(i)));
        let logs = Logs::new().with("a.csv", text);
        println!("{name}");
        let columns = format!("columns = {{ time_s = {time}, normal_force = \"Fz\" }}\n");
        is_whole(
            &logs,
            &format!("file = \"a.csv\"\ndelimiter = \";\"\n{columns}"),
        );
    }
}

#[test]
fn cells_that_are_no_numbers_are_told_by_what_they_are() {
    let plain = |i| format!("{:.2};{}", time(i), force(i));
    let cases: [(&str, String, &str); 8] = [
        (
            "points between thousands",
            log("t;Fz\n", |i| format!("{i};1.{:03},5", 100 + i)),
            "between their thousands",
        ),
        (
            "apostrophes",
            log("t;Fz\n", |i| format!("{i};1'{:03}.5", 100 + i)),
            "between their thousands",
        ),
        (
            "narrow blanks",
            log("t;Fz\n", |i| format!("{i};1\u{202f}{:03}", 100 + i)),
            "between their thousands",
        ),
        (
            "a unit in each cell",
            log("t;Fz\n", |i| plain(i) + " N"),
            "its unit in the campaign",
        ),
        (
            "a log that was started anew",
            log("t;Fz\n", plain) + &log("t;Fz\n", plain),
            "a.csv:42: column \"Fz\" holds \"Fz\", which is no number; the header stands here again",
        ),
        (
            "a plotter's labels",
            log("t:0.00;Fz:100.0\n", |i| {
                plain(i).replace(';', ";Fz:").replacen("", "t:", 1)
            }),
            "its cells hold names and numbers (\"t:0.00\")",
        ),
        (
            "a serial monitor's stamps",
            log("t;Fz\n", |i| {
                format!("10:00:00.{:03} -> {}", 10 * i, plain(i))
            }),
            "stands before ->; remove it",
        ),
        (
            "a word",
            log("t;Fz\n", |i| format!("{i};high")),
            "leave a cell empty where nothing was measured",
        ),
    ];
    for (name, text, told) in cases {
        let logs = Logs::new().with("a.csv", text);
        let message = logs.refused(&format!("file = \"a.csv\"\ndelimiter = \";\"\n{COLUMNS}"));
        assert!(message.contains(told), "{name}: {message}");
    }
}

#[test]
fn what_spreadsheets_and_pandas_write_for_nothing_is_a_gap() {
    for nothing in [
        "", "NaN", "None", "<NA>", "#N/A", "#DIV/0!", "1.#QNAN", "-nan", "NULL", "inf",
    ] {
        let cell = |i| {
            if i == 5 {
                nothing.to_owned()
            } else {
                force(i).to_string()
            }
        };
        let text = log("t,Fz\n", |i| format!("{:.2},{}", time(i), cell(i)));
        let logs = Logs::new().with("a.csv", text);
        let trace = logs.run(&format!("file = \"a.csv\"\n{COLUMNS}"));
        let samples = &channel(&trace, "normal_force").samples;
        let gaps: Vec<usize> = (0..samples.len())
            .filter(|&i| samples[i].is_nan())
            .collect();
        assert_eq!(gaps, [5], "{nothing}");
    }
}

#[test]
fn lines_are_counted_as_an_editor_counts_them() {
    for end in ["\n", "\r\n", "\r"] {
        for (lead, line) in [
            ("t,Fz\n", 7),
            ("# rig 3\n\nt,Fz\ns,N\n", 10),
            ("t,Fz\n# a remark\n\n", 9),
        ] {
            let cell = |i| {
                if i == 5 {
                    "high".to_owned()
                } else {
                    force(i).to_string()
                }
            };
            let text = log(lead, |i| format!("{:.2},{}", time(i), cell(i)));
            let logs = Logs::new().with("a.csv", text.replace('\n', end));
            let message = logs.refused(&format!("file = \"a.csv\"\n{COLUMNS}"));
            says(
                &message,
                &[&format!("a.csv:{line}: column \"Fz\" holds \"high\"")],
            );
        }
    }
}

#[test]
fn a_bag_echoed_without_a_header_and_a_logger_with_dates_make_one_run() {
    let bag = log("", |i| {
        let nanoseconds = 250_000_000 + 10_000_000 * i;
        format!("1714730400,{nanoseconds},base_link,{}", force(i))
    });
    let dates = log("time,z\n", |i| {
        format!("2024-05-03 10:00:00.{:03},{i}", 100 + 20 * i)
    });
    let logs = Logs::new().with("bag.csv", bag).with("logger.csv", dates);
    let bag = "[[run.source]]\nfile = \"bag.csv\"\n";
    let columns = "columns = { time_s = { column = \"s\", add = { column = \"ns\", unit = \"ns\" } }, normal_force = \"Fz\" }\n";
    says(
        &logs.refused(&format!("{bag}{columns}")),
        &[
            "first row holds numbers",
            "name the columns with names = [...]",
        ],
    );
    let bag = format!("{bag}names = [\"s\", \"ns\", \"frame\", \"Fz\"]\n{columns}");
    let logger = "[[run.source]]\nfile = \"logger.csv\"\ncolumns = { time_s = \"time\", sinkage = { column = \"z\", unit = \"mm\" } }\n";
    let trace = logs.run(&format!("{bag}{logger}"));
    let place = |name| {
        let channel = channel(&trace, name);
        (channel.start, channel.sample_rate)
    };
    assert_eq!(place("normal_force"), (0.0, 100.0));
    assert!((place("sinkage").0 + 0.15).abs() < 1e-9 && place("sinkage").1 == 50.0);
    noted(&trace, "joined by time");
}

#[test]
fn stamps_in_single_precision_and_of_a_tired_host_are_told_with_a_rate_that_works() {
    let single = |i: u32| f64::from((100_000.0 + 0.001 * f64::from(i)) as f32);
    let host = |i: u32| 0.02 * f64::from(i) + 0.013 * (2.4 * f64::from(i)).sin().max(0.0);
    let table = |stamp: &dyn Fn(u32) -> f64, rows| {
        table("t,Fz", rows, |i| format!("{:.7},{}", stamp(i), force(i)))
    };
    let logs = Logs::new()
        .with("single.csv", table(&single, 2000))
        .with("host.csv", table(&host, 400));
    for (file, rate) in [("single.csv", 1000.0), ("host.csv", 50.0)] {
        let message = logs.refused(&format!("file = \"{file}\"\n{COLUMNS}"));
        let stated = message.split("sample_rate_hz = ").nth(1);
        let stated = stated
            .unwrap_or_else(|| panic!("{message}"))
            .split(' ')
            .next()
            .unwrap();
        assert!(
            (stated.parse::<f64>().unwrap() / rate - 1.0).abs() < 0.05,
            "{message}"
        );
        let columns = "columns = { normal_force = \"Fz\" }\n";
        let trace = logs.run(&format!(
            "file = \"{file}\"\nsample_rate_hz = {rate}\n{columns}"
        ));
        assert_eq!(channel(&trace, "normal_force").sample_rate, rate);
    }
}

#[test]
fn a_wheel_speed_of_20_rad_s_at_2_hz_turns_the_wheel_by_10_rad_a_sample() {
    let text = table("t,w,v", 120, |i| {
        let wobble = (TAU * 0.05 * f64::from(i)).sin();
        format!(
            "{:.1},{:.3},{:.4}",
            0.5 * f64::from(i),
            20.0 + 0.3 * wobble,
            2.66 + 0.04 * wobble
        )
    });
    let logs = Logs::new().with("a.csv", text);
    let run = "file = \"a.csv\"\nwheel = { radius_m = 0.14, width_m = 0.15, lug_count = 28, lug_height_m = 0.015 }\n\
               load_n = 100\nterrain = \"HT\"\n\
               columns = { time_s = \"t\", wheel_speed = \"w\", forward_speed = \"v\" }\n";
    for command in ["", "speed_m_s = 2.66\nslip_ratio = 0.05\n"] {
        let trace = logs.run(&format!("{command}{run}"));
        let turned = channel(&trace, "wheel_angle").samples.last().unwrap() / 59.5;
        assert!((turned - 20.0).abs() < 0.1, "{turned}");
        let found = lugwheel::dataset::inspection::findings("run", &trace);
        assert_eq!(found, [], "{command}");
    }
}
