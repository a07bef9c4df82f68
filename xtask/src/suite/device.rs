//! The devices without hardware: a Cortex-M4F, emulated, gives the host's bits; firmware for the boards; nodes and
//! receiver over virtual Bluetooth; the Spresense sketch, on this machine and for the board.

use std::time::Duration;

use super::Suite;
use crate::cross::CORTEX_M4F;
use crate::digests;
use crate::firmware;
use crate::logic;
use crate::needs::{Apt, Needs};
use crate::project::{Project, on_path};
use crate::run::{Run, heading, must, output_within};
use crate::virtual_bluetooth;

pub const SUITE: Suite = Suite {
    name: "device",
    about: "emulated Cortex-M4F, firmware and UF2 files, virtual Bluetooth, the Spresense sketch",
    needs: |project| {
        let mut needs = firmware::needs(project);
        needs.apt.push(Apt::program("qemu-system-arm", "qemu-system-arm"));
        needs.pip.extend(virtual_bluetooth::PIP);
        needs
    },
    wants: |_| Needs {
        apt: vec![
            Apt::program("g++", "g++"),
            Apt::program("gcc-arm-none-eabi", "arm-none-eabi-g++"),
            Apt::file("libnewlib-arm-none-eabi", "/usr/include/newlib/stdint.h"),
        ],
        ..Needs::default()
    },
    builds: build,
    run,
};

fn build(project: &Project) -> Result<(), String> {
    build_digest(project)?;
    logic::build(project)?;
    virtual_bluetooth::build(project)?;
    firmware::BOARDS.iter().try_for_each(|board| firmware::build(project, board).map(drop))
}

fn run(run: &mut Run<'_>) {
    let project = run.project;
    // minutes of one processor, while the radio's tests mostly wait
    let printed = std::thread::scope(|scope| {
        let printed = scope.spawn(|| emulate(project));
        everything_else(run);
        printed.join().unwrap_or_else(|_| Err("the emulation itself panicked".into()))
    });
    heading("digest on Cortex-M4F");
    digests::compare(run, CORTEX_M4F.triple, printed);
}

fn everything_else(run: &mut Run<'_>) {
    heading("the node's logic on Cortex-M4F");
    logic::compare(run);
    virtual_bluetooth::run(run);
    heading("firmware");
    for board in firmware::BOARDS {
        let packed = firmware::build(run.project, board).and_then(|program| firmware::pack(&program));
        run.check(board, packed.map(|(file, size)| format!("{size}; {}", file.display())));
    }
    let notice = std::fs::read_to_string(run.project.root.join(firmware::NOTICE)).unwrap_or_default();
    let named = ["Nordic Semiconductor", "5. Any software provided in binary form"]
        .iter()
        .all(|part| notice.contains(part));
    run.check(
        "NOTICE",
        if named { Ok(String::new()) } else { Err(format!("{} lacks Nordic's licence", firmware::NOTICE)) },
    );
    heading("Spresense sketch");
    spresense(run);
}

/// The sketch on this machine against a fake sensor, and compiled for the board against stub headers.
fn spresense(run: &mut Run<'_>) {
    let folder = run.project.root.join("apps/spresense");
    let out = run.project.target().join("spresense");
    if let Err(error) = std::fs::create_dir_all(&out) {
        run.fail("spresense", &error.to_string());
        return;
    }
    if on_path("g++") {
        let program = out.join("host_test");
        let mut build = run.project.command("g++");
        build.args(["-std=c++14", "-O1", "-Wall", "-Wextra", "-Werror", "-I"]);
        build.arg(folder.join("test/stubs")).arg(folder.join("test/host_test.cpp")).arg("-o").arg(&program);
        if run.step("the sketch builds for this machine", &mut build) {
            let mut test = run.project.command(&program);
            run.step("the sketch against a fake sensor", &mut test);
        }
    } else {
        run.skip("the sketch against a fake sensor", "g++ is not here");
    }
    if on_path("arm-none-eabi-g++") {
        let mut build = run.project.command("arm-none-eabi-g++");
        build.args(["-std=gnu++14", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
        build.args(["-Os", "-Wall", "-Wextra", "-Werror", "-x", "c++", "-c", "-I"]);
        build.arg(folder.join("test/stubs")).arg(folder.join("earth_rate/earth_rate.ino"));
        build.arg("-o").arg(out.join("earth_rate.o"));
        run.step("the sketch builds for the board", &mut build);
    } else {
        run.skip("the sketch builds for the board", "arm-none-eabi-g++ is not here");
    }
}

fn build_digest(project: &Project) -> Result<(), String> {
    // In its folder, for the linker's options in its .cargo/config.toml.
    must(CORTEX_M4F.cargo_build(project).current_dir(project.root.join("firmware/digest")))
}

fn emulate(project: &Project) -> Result<String, String> {
    build_digest(project)?;
    let mut qemu = project.command("qemu-system-arm");
    qemu.args(logic::QEMU).arg(CORTEX_M4F.products(project).join("digest-firmware"));
    output_within(&mut qemu, Duration::from_secs(900))
}
