//! A C program, written from the table, compiled against include/shisei.h and linked with the library, runs
//! every example, the error codes, and four threads at once.

use shisei_functions::{ExampleArg, Expected, FUNCTIONS, Function, VERSION};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

#[test]
fn a_compiled_c_program_runs_every_example() {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    if Command::new(&compiler).arg("--version").output().is_err() {
        eprintln!("skipped: no C compiler ({compiler})");
        return;
    }
    let crate_dir = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let library_dir = library_dir();
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (source, program) = (dir.join("examples.c"), dir.join("examples"));
    std::fs::write(&source, c_source()).unwrap();
    let built = Command::new(&compiler)
        .args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-pthread", "-I"])
        .arg(crate_dir.join("include"))
        .arg("-o")
        .args([&program, &source])
        .arg("-L")
        .arg(&library_dir)
        .args(["-lshisei", "-lm"])
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let run = Command::new(&program).env("LD_LIBRARY_PATH", &library_dir).output().unwrap();
    let text = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{text}{}", String::from_utf8_lossy(&run.stderr));
    assert!(text.ends_with("all right\n"), "{text}");
}

/// The directory of libshisei.so: beside the tests' own directory.
fn library_dir() -> PathBuf {
    let exe = std::env::current_exe().unwrap();
    let deps = exe.parent().unwrap();
    let up = deps.parent().unwrap();
    let name = format!("{}shisei{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    if deps.join(&name).exists() { deps.to_path_buf() } else { up.to_path_buf() }
}

fn c_source() -> String {
    let mut s = String::from(HEAD);
    for (i, f) in FUNCTIONS.iter().enumerate() {
        if !matches!(f.example.expected, Expected::Sentence) {
            s += &example(i, f);
        }
    }
    s += "static int all_examples(void) {\n    int bad = 0;\n";
    for (i, f) in FUNCTIONS.iter().enumerate() {
        if !matches!(f.example.expected, Expected::Sentence) {
            let _ = writeln!(s, "    bad += example_{i}();");
        }
    }
    s += "    return bad;\n}\n";
    s += &TAIL.replace("@VERSION@", VERSION);
    s
}

fn numbers(data: &[f64]) -> String {
    data.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")
}

fn example(i: usize, f: &Function) -> String {
    let (data, tolerance) = match f.example.expected {
        Expected::Numbers { data, tolerance, .. } => (data.to_vec(), tolerance),
        Expected::Truth(truth) => (vec![f64::from(u8::from(truth))], 0.0),
        Expected::Sentence => unreachable!(),
    };
    let mut call = String::new();
    let mut s = format!("static int example_{i}(void) {{\n");
    for (k, arg) in f.args.iter().enumerate() {
        match f.example.args.get(k) {
            Some(ExampleArg::Number(x)) => {
                let _ = write!(call, "{x:?}, ");
            }
            Some(ExampleArg::Range { data, cols }) => {
                let _ = writeln!(s, "    static const double a{k}[] = {{{}}};", numbers(data));
                let _ = write!(call, "a{k}, {}, {cols}, ", data.len() / cols);
            }
            Some(ExampleArg::Missing) | None => {
                assert!(arg.default.is_some());
                call += "NAN, ";
            }
        }
    }
    let n = data.len();
    let _ = write!(
        s,
        "    static const double want[] = {{{}}};\n    double out[{n}];\n    \
         int32_t n = {}({call}out, {n});\n    \
         return check(\"{}\", n, {n}, out, want, {tolerance:e});\n}}\n",
        numbers(&data),
        f.export,
        f.name
    );
    s
}

const HEAD: &str = r#"
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include "shisei.h"

static int check(const char *name, int32_t n, int32_t want_n, const double *out, const double *want, double tolerance) {
    if (n != want_n) {
        char text[512];
        shisei_last_error(text, sizeof text, "en");
        printf("%s gave %d: %s\n", name, (int)n, text);
        return 1;
    }
    for (int32_t i = 0; i < n; i++) {
        if (!(fabs(out[i] - want[i]) <= tolerance)) {
            printf("%s [%d]: %.17g, expected %.17g\n", name, (int)i, out[i], want[i]);
            return 1;
        }
    }
    return 0;
}
"#;

const TAIL: &str = r#"
static void *in_a_thread(void *ignored) {
    (void)ignored;
    int bad = 0;
    for (int k = 0; k < 200; k++) bad += all_examples();
    return bad ? (void *)1 : NULL;
}

#define EXPECT(condition) do { if (!(condition)) { printf("line %d: %s\n", __LINE__, #condition); bad++; } } while (0)

int main(void) {
    int bad = all_examples();
    double out[8], nine[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, zero[4] = {0, 0, 0, 0}, one[4] = {1, 0, 0, 0};
    char text[512], small[8];
    EXPECT(shisei_last_error(text, sizeof text, "en") == 0 && text[0] == 0);
    EXPECT(GetYawPitchRollSeries(nine, 3, 3, out, 8) == SHISEI_ERROR_SHAPE);
    EXPECT(shisei_last_error(text, sizeof text, NULL) > 0 && strstr(text, "3\xc3\x97" "3"));
    EXPECT(shisei_last_error(small, sizeof small, "ja") > 8 && strlen(small) == 7);
    EXPECT(GetYawPitchRollSeries(nine, 0, 4, out, 8) == SHISEI_ERROR_SHAPE);
    EXPECT(GetYawPitchRollSeries(NULL, 2, 4, out, 8) == SHISEI_ERROR_SHAPE);
    EXPECT(GetYawPitchRollSeries(nine, -1, 4, out, 8) == SHISEI_ERROR_SHAPE);
    EXPECT(NormalizeQuaternion(zero, 1, 4, out, 8) == SHISEI_ERROR_DOMAIN);
    EXPECT(shisei_last_error(text, sizeof text, "ja") > 0 && strstr(text, "\xe3\x82\xaf"));
    EXPECT(UpdateQuaternionByGyro(one, 4, 1, nine, 1, 3, 0.0, out, 8) == SHISEI_ERROR_DOMAIN);
    EXPECT(UpdateQuaternionByGyro(one, 4, 1, nine, 1, 3, NAN, out, 8) == SHISEI_ERROR_DOMAIN);
    EXPECT(GetInitialQuaternionFromAcc(nine, 3, 3, 0.0, 9, 10, out, 8) == SHISEI_ERROR_CONDITION);
    EXPECT(IdentityQuaternion(out, 3) == SHISEI_ERROR_OUT);
    EXPECT(IdentityQuaternion(NULL, 4) == SHISEI_ERROR_OUT);
    zero[1] = NAN;
    EXPECT(IsFiniteQuaternion(zero, 1, 4, out, 1) == 1 && out[0] == 0.0);
    EXPECT(shisei_version(text, sizeof text) > 0 && !strcmp(text, "@VERSION@") && !strcmp(text, SHISEI_VERSION));
    pthread_t threads[4];
    for (int k = 0; k < 4; k++) EXPECT(pthread_create(&threads[k], NULL, in_a_thread, NULL) == 0);
    for (int k = 0; k < 4; k++) {
        void *result;
        EXPECT(pthread_join(threads[k], &result) == 0 && result == NULL);
    }
    if (bad) return 1;
    puts("all right");
    return 0;
}
"#;
