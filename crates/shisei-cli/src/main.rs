//! The `shisei` command: parses, calls, prints. No formula lives here.

#[macro_use]
mod speak;

mod args;
mod args_fuse;
mod args_ja;
mod args_live;
mod args_measure;
mod batch;
mod calibration;
mod cmd;
mod demo;
mod fail;
mod fuse_inputs;
mod fuse_report;
mod input;
mod lang;
mod ours;
mod outgoing;
mod output;
mod stillness;
mod summary;
mod tables;
mod threads;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches};
use shisei_core::Lang;

use args::{Cli, Command};
use fail::{Exit, Failure, Outcome, say};

fn main() -> ExitCode {
    let arguments: Vec<std::ffi::OsString> = std::env::args_os().collect();
    let lang = lang::choose(&arguments);
    let worked = std::panic::catch_unwind(|| run(&arguments, lang));
    match worked {
        Ok(Ok(())) => match speak::unsaid() {
            None => ExitCode::SUCCESS,
            Some(error) => ended(&Failure::input(output::unwritable("-", error, lang))),
        },
        Ok(Err(failure)) => ended(&failure),
        Err(_) => {
            eprintln!(
                "{}",
                say(
                    lang,
                    concat!(
                        "this is a fault of shisei ",
                        env!("CARGO_PKG_VERSION"),
                        "; please report the lines above, the command and, if you can, the file"
                    ),
                    concat!(
                        "shisei ",
                        env!("CARGO_PKG_VERSION"),
                        " の不具合です。上の表示、実行したコマンド、可能であればファイルをお知らせください"
                    ),
                )
            );
            ExitCode::from(Exit::Internal as u8)
        }
    }
}

fn ended(failure: &Failure) -> ExitCode {
    eprintln!("{}", failure.sentence);
    ExitCode::from(failure.exit as u8)
}

fn run(arguments: &[std::ffi::OsString], lang: Lang) -> Outcome<()> {
    let mut command = args::with_checked_numbers(Cli::command());
    if lang == Lang::Ja {
        command = args_ja::localize(command);
    }
    let parsed = command.try_get_matches_from(arguments).and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(error) => return usage(&error, lang),
    };
    match cli.command {
        Command::Info(args) => cmd::info::run(&args, lang),
        Command::Orient(args) => cmd::orient::run(args, lang),
        Command::Calibrate(args) => cmd::calibrate::run(&args, lang),
        Command::Apply(args) => cmd::apply::run(&args, lang),
        Command::Convert(args) => cmd::convert::run(&args, lang),
        Command::Fuse(args) => cmd::fuse::run(&args, lang),
        Command::Motion(args) => cmd::motion::run(&args, lang),
        Command::Allan(args) => cmd::allan::run(&args, lang),
        Command::Earth(args) => cmd::earth::run(&args, lang),
        Command::Devices(args) => cmd::devices::run(&args, lang),
        Command::Record(args) => cmd::record::run(&args, lang),
        Command::Live(args) => cmd::live::run(args, lang),
        Command::Simulate(args) => cmd::simulate::run(&args, lang),
    }
}

/// Help and version go to standard output; what is wrong with the arguments is said with exit 2.
fn usage(error: &clap::Error, lang: Lang) -> Outcome<()> {
    if !error.use_stderr() {
        print!("{error}");
        return Ok(());
    }
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand || lang == Lang::En {
        return Err(Failure::input(error.to_string().trim_end().to_owned()));
    }
    let context = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let argument = context(clap::error::ContextKind::InvalidArg);
    let value = context(clap::error::ContextKind::InvalidValue);
    let sentence = match error.kind() {
        ErrorKind::UnknownArgument => format!("オプション {argument} はありません"),
        ErrorKind::InvalidSubcommand => {
            format!("コマンド {} はありません", context(clap::error::ContextKind::InvalidSubcommand))
        }
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            let valid = context(clap::error::ContextKind::ValidValue);
            let hint =
                if valid.is_empty() { String::new() } else { format!("。指定できる値: {valid}") };
            format!("{argument} の値 {value} は正しくありません{hint}")
        }
        ErrorKind::MissingSubcommand => {
            let valid = context(clap::error::ContextKind::ValidSubcommand);
            format!("コマンドを指定してください: {valid}")
        }
        ErrorKind::MissingRequiredArgument => format!("必要な引数がありません: {argument}"),
        ErrorKind::ArgumentConflict => {
            format!("{argument} は {} と同時に指定できません", context(clap::error::ContextKind::PriorArg))
        }
        _ => return Err(Failure::input(error.to_string().trim_end().to_owned())),
    };
    Err(Failure::input(format!("{sentence}。使い方は shisei --help で確認できます")))
}
