//! A run overwrites shisei's own earlier results and no other file; what it keeps of an input it can open again.

use crate::run::{Desk, example};

/// Somebody else's file of this name and content is left as it is.
fn check_left(args: &[&str], name: &str, content: &[u8]) {
    let desk = Desk::new();
    desk.put(name, content);
    for (lang, words) in [("en", "not a result of shisei"), ("ja", "shisei のこの種類の出力ではありません")]
    {
        let ran = desk.run(&[args, &["--lang", lang]].concat());
        assert_eq!(ran.code, 2, "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words) && ran.stderr.contains("--force"), "{args:?}: {}", ran.stderr);
    }
    assert_eq!(std::fs::read(desk.file(name)).expect("the file"), content, "{args:?}");
    assert_eq!(desk.names(), [name]);
}

#[test]
fn other_peoples_files_are_left_alone() {
    let pelvis = example("pelvis.csv");
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let polars = std::fs::read(format!("{root}/fixtures/parquet/text.parquet")).expect("the fixture");
    for parquet in
        [b"PAR1 my thesis".as_slice(), b"PAR1", b"PAR1\xff\xff\xff\xffPAR1", b"\x15\0\x10\0\0\0PAR1", &polars]
    {
        check_left(&["orient", &pelvis, "--no-report", "-o", "t.parquet"], "t.parquet", parquet);
        check_left(&["convert", &pelvis, "-o", "t.parquet"], "t.parquet", parquet);
    }
    check_left(
        &["convert", &pelvis, "-o", "t.csv"],
        "t.csv",
        b"time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,label\n0,0,0,9.8,0,0,0,rest\n",
    );
    check_left(
        &["orient", &pelvis, "--no-report", "-o", "t.csv"],
        "t.csv",
        b"time_s,q_w,q_x,q_y,q_z,yaw_rad,pitch_rad,roll_rad,subject\n0,1,0,0,0,0,0,0,me\n",
    );
    // Before the take is read.
    let fuse = |name| ["fuse", "take.csv", "imu.csv", "--no-report", "-o", name];
    check_left(
        &fuse("ik.mot"),
        "ik.mot",
        b"Coordinates\nversion=1\nnRows=1\nnColumns=4\ninDegrees=yes\nendheader\ntime\tpelvis_tx\tpelvis_ty\tpelvis_tz\n0\t0\t0\t0\n",
    );
    check_left(
        &fuse("imus.sto"),
        "imus.sto",
        b"DataRate=100.000000\nDataType=Quaternion\nversion=3\nOpenSimVersion=4.5\nendheader\ntime\tpelvis_imu\n0\t1,0,0,0\n",
    );
}

/// Twice the same, with each kind of table, with and without the input's other columns.
#[test]
fn a_run_can_be_repeated() {
    let desk = Desk::new();
    let pelvis = std::fs::read_to_string(example("pelvis.csv")).expect("the example");
    let labelled: String = pelvis
        .lines()
        .enumerate()
        .map(
            |(k, line)| {
                if k == 0 { format!("{line},\"a, label\"\n") } else { format!("{line},\"step, 1\"\n") }
            },
        )
        .collect();
    desk.put("in.csv", labelled);
    for name in ["t.csv", "t.parquet"] {
        for command in [&["orient", "--no-report"][..], &["orient", "--no-report", "--degrees"], &["convert"]]
        {
            for keep in [&[][..], &["--keep"]] {
                let place = ["in.csv", "-o", name];
                for force in [&["--force"][..], &[]] {
                    let ran = desk.run(&[command, &place, keep, force].concat());
                    assert_eq!(ran.code, 0, "{command:?} {keep:?} {name}: {}", ran.stderr);
                }
            }
        }
    }
    assert!(desk.text("t.csv").lines().next().is_some_and(|head| head.ends_with(",gyr_z,\"a, label\"")));
    // A directory with such results in it holds one recording all the same.
    for keep in [&[][..], &["--keep"]] {
        let ran = desk.run(&[&["orient", "in.csv", "--no-report"][..], keep].concat());
        assert_eq!(ran.code, 0, "{}", ran.stderr);
    }
    std::fs::remove_file(desk.file("t.csv")).expect("written");
    std::fs::remove_file(desk.file("t.parquet")).expect("written");
    let ran = desk.run(&["orient", ".", "--no-report", "--keep", "--lang", "en"]);
    assert!(ran.stderr.contains("1 done, 0 failed"), "{}", ran.stderr);
}

/// Results of versions that did not mark them: by their columns.
#[test]
fn results_of_earlier_versions_are_our_own() {
    let desk = Desk::new();
    desk.put("t.csv", "time_s,q_w,q_x,q_y,q_z,yaw_rad,pitch_rad,roll_rad\n0,1,0,0,0,0,0,0\n");
    let ran = desk.run(&["orient", &example("pelvis.csv"), "--no-report", "-o", "t.csv"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
}

#[test]
fn kept_columns_are_those_that_were_not_used() {
    let desk = Desk::new();
    let pelvis = std::fs::read_to_string(example("pelvis.csv")).expect("the example");
    desk.put("in.csv", pelvis.replacen("Time,", "time_s,", 1));
    desk.run(&["convert", "in.csv", "-o", "a.csv"]);
    let ran = desk.run(&["convert", "a.csv", "-o", "b.csv", "--keep"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(desk.text("b.csv"), desk.text("a.csv"), "nothing is left to keep");
    let ran = desk.run(&["info", "b.csv"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
}

#[test]
fn a_kept_column_with_the_name_of_ours_is_renamed() {
    let desk = Desk::new();
    let own: String = (0..600).map(|k| format!("{},0,0,9.8,0,0,0,{k},1,A\n", f64::from(k) / 100.0)).collect();
    desk.put("in.csv", format!("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,q_w,rest,q_w_kept\n{own}"));
    for (lang, words) in [("en", "column q_w is called q_w_kept_kept"), ("ja", "列 q_w は")] {
        let args = ["orient", "in.csv", "--keep", "--no-report", "-o", "out.csv", "--lang", lang];
        let ran = desk.run(&args);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
    let text = desk.text("out.csv");
    let head = text.lines().next().expect("a header");
    assert!(head.ends_with("rest,\"q_w_kept_kept\",\"rest_kept\",\"q_w_kept\""), "{head}");
    let names: std::collections::HashSet<&str> = head.split(',').collect();
    assert_eq!(names.len(), head.split(',').count(), "{head}");
    // Where there is no other, its name stays.
    desk.run(&["convert", "in.csv", "--keep", "-o", "out2.csv"]);
    assert!(
        desk.text("out2.csv")
            .starts_with("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,\"q_w\",\"rest\",\"q_w_kept\"\n")
    );
}
