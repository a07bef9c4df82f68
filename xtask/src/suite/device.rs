//! A Cortex-M4F, emulated: the same bits as the host.

use std::time::Duration;

use super::Suite;
use crate::cross::CORTEX_M4F;
use crate::digests;
use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::{Run, heading, must, output_within};

pub const SUITE: Suite = Suite {
    name: "device",
    about: "the core's digest on an emulated Cortex-M4F",
    needs: |project| {
        let mut needs = CORTEX_M4F.needs(project);
        needs.apt.push(Apt::program("qemu-system-arm", "qemu-system-arm"));
        needs
    },
    wants: |_| Needs::default(),
    run,
};

fn run(run: &mut Run<'_>) {
    heading("digest on Cortex-M4F");
    digests::compare(run, CORTEX_M4F.triple, emulate(run.project));
}

fn emulate(project: &Project) -> Result<String, String> {
    // In its folder, for the linker's options in its .cargo/config.toml.
    must(CORTEX_M4F.cargo_build(project).current_dir(project.root.join("firmware/digest")))?;
    let mut qemu = project.command("qemu-system-arm");
    qemu.args([
        "-M",
        "mps2-an386",
        "-nographic",
        "-semihosting-config",
        "enable=on,target=native",
        "-kernel",
    ]);
    qemu.arg(CORTEX_M4F.products(project).join("digest-firmware"));
    output_within(&mut qemu, Duration::from_secs(300))
}
