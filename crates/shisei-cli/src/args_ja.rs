//! Japanese texts of the command line, one for each command and option.

use clap::{Arg, Command};

const COMMANDS: &[(&str, &str)] = &[
    ("shisei", "加速度・ジャイロの記録から、姿勢・運動・キャリブレーションを求めます"),
    ("info", "記録の内容 (列、単位、レート、欠落、静止区間、推定した前提) を表示します"),
    ("orient", "姿勢 (ヨー・ピッチ・ロール) を計算し、数値とレポートを出力します"),
    ("calibrate", "キャリブレーションを求めます (6 面静止、多姿勢、既知の回転)"),
    ("fuse", "光学計測のテイク (Motive CSV) の欠落を、同じ物体の慣性センサの記録で補います"),
    ("motion", "速度と位置を誤差幅つきで求めます (静止から静止、または足に付けた歩行)"),
    ("allan", "全軸のアラン偏差: 雑音、バイアス安定度、平均時間の目安を求めます"),
    ("earth", "地球の自転を測ります: 恒星日、緯度、真北"),
    ("apply", "キャリブレーションを記録に適用します"),
    ("devices", "シリアルポート、レシーバ、ノードを一覧表示し、ノードの点滅・名前・設定を操作します"),
    ("record", "レシーバのデータを記録します"),
    (
        "live",
        "センサとカメラのデータを統合し、ブラウザでリアルタイムに表示します。記録・再生・転送もできます",
    ),
    ("simulate", "手元にない機器をシミュレーションします"),
    ("lab", "ノード、無線、カメラのパルス、レシーバを再現し、実機と同じように使えるシリアルポートを作ります"),
    ("convert", "記録を shisei の列に変換し、CSV または Parquet で書き出します"),
];

/// By an argument's id; `command.id` is for that command only.
const OPTIONS: &[(&str, &str)] = &[
    ("optical", "テイク: Motive のトラッキング CSV"),
    ("imu", "同じ物体の慣性センサの記録 (加速度とジャイロが別の場合は 2 ファイル)"),
    (
        "fused",
        "統合結果の出力先。拡張子で形式が決まります: .csv、.parquet、.sto、.mot、.glb、.mcap。複数指定できます (省略時は作業ディレクトリの NAME.fused.csv)",
    ),
    ("motive", "欠落を補ったテイクを Motive の CSV としても書き出します"),
    ("body", "センサを付けた剛体、または SKELETON:BONE (テイクに複数ある場合)"),
    (
        "sync",
        "時刻合わせの方法: 回転の速さ (rates)、受信機のフレーム番号 (sequence、frame 列)、またはカメラのパルスのファイル (pulse-file、--pulses)",
    ),
    (
        "pulses",
        "--sync pulse-file で使うファイル: 各カメラパルスの時刻 (記録の時計、秒)。フレーム 0 から 1 行に 1 つ",
    ),
    (
        "fuse_mode",
        "bridge: 剛体に付けたセンサで欠落を補う。relative: 剛体やボーン (--parent) が持つ、マーカーのない道具にセンサを付けた場合",
    ),
    ("parent", "--mode relative で道具を持つ側の剛体、または SKELETON:BONE"),
    (
        "grip",
        "--mode relative での道具の位置 (親の座標軸、m) と、基準フレームでのセンサの向き (ヨー、ピッチ、ロール、度)",
    ),
    (
        "reference",
        "--mode relative で、道具が --grip のとおりに持たれているフレーム (省略時は両方が揃う最初のフレーム)",
    ),
    ("world", "出力の座標系: z-up、y-up、unity (省略時はテイクのまま)"),
    ("frozen", "姿勢がこの回数だけ完全に同じなら欠落とみなします。0 で無効"),
    ("lang", "メッセージ・ヘルプ・レポートの言語: en または ja (省略時はロケールに従います)"),
    ("files", "記録ファイル。- は標準入力です"),
    ("orient.files", "記録ファイル、またはそのディレクトリ。- は標準入力です"),
    (
        "calibrate.files",
        "6 面それぞれで 3 秒以上静止した記録、または多数の姿勢で静止した記録。- は標準入力です",
    ),
    ("convert.files", "記録ファイル 1 つ、または加速度とジャイロの 2 ファイル。- は標準入力です"),
    ("motion.files", "静止で始まる (rest-to-rest では静止で終わる) 記録。- は標準入力です"),
    ("allan.files", "動かないセンサの記録。長いほどよい結果になります。- は標準入力です"),
    (
        "earth.files",
        "方向ごとの記録、または平均角速度の表 1 つ (gyr_x,gyr_y,gyr_z [rad/s]。acc_x … と heading_deg も可)",
    ),
    (
        "columns",
        "列の意味。ファイルの順に time,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z (その他の列は '-')、または acc_x=列名,…",
    ),
    ("units", "ファイルに書かれていない単位: 例 acc=g,gyr=deg/s,time=ms"),
    ("rate", "時刻の代わりに使うサンプリング周波数 [Hz]"),
    ("axes", "新しい x, y, z 軸を記録の軸で指定: 例 x,-y,-z は z 軸下向きのセンサを直します"),
    ("scale", "生データの 1 g あたり、1 deg/s あたりのカウント数 (データシートの値): 例 acc=16384,gyr=131"),
    ("skip_bad_rows", "欠けた値や読めない値のある行を、エラーにせず取り除きます"),
    ("sensor", "複数のセンサを含むファイルで、使うセンサの名前"),
    ("json", "結果を 1 つの JSON として標準出力に書きます"),
    ("calibrate.json", "キャリブレーションを標準出力にも JSON で書きます"),
    (
        "orient.output",
        "姿勢の出力先 (.csv または .parquet。省略時は作業ディレクトリの NAME.orientation.csv)。記録が複数ならディレクトリ。- は標準出力です",
    ),
    (
        "calibrate.output",
        "キャリブレーションの出力先 (省略時は作業ディレクトリの NAME.calibration.json)。- は標準出力です",
    ),
    ("apply.output", "補正した記録の出力先 (.csv または .parquet)。- は標準出力です"),
    ("convert.output", "出力先 (.csv または .parquet)。- は標準出力 (CSV) です"),
    ("motion.output", "運動の出力先 (省略時は作業ディレクトリの NAME.motion.csv)。- は標準出力です"),
    ("allan.output", "曲線の表の出力先 (省略時は作業ディレクトリの NAME.allan.csv)。- は標準出力です"),
    ("earth.output", "--serial で計測した方向の表の出力先 (省略時は作業ディレクトリの directions.csv)"),
    ("record.output", "記録の出力先"),
    ("record.force", "既存のファイルを上書きします"),
    ("lab.output", "ポートを用意する代わりに、レシーバの出力を実時間より速くファイルに書き出します"),
    (
        "filter",
        "姿勢の推定方法。shisei は記録全体を、shisei-online はその時点までを使います。その他は古典的な方法です",
    ),
    (
        "save_calibration",
        "センサについて学習した結果を保存し、次回 --calibration に使えるようにします (shisei、shisei-online)",
    ),
    ("kp", "Mahony の比例ゲイン [1/s]。小さいほどジャイロ、大きいほど加速度を信頼します (省略時 0.2)"),
    ("ki", "Mahony の積分ゲイン [1/s²]。ジャイロのバイアスを学習します。0 で無効 (省略時 0)"),
    ("kp_min", "mahony-adaptive の最小ゲイン [1/s] (省略時 0.05。最大は kp、省略時 2)"),
    (
        "accel_limits",
        "mahony-adaptive のゲインが下がる加速度 [m/s²]: 下端, 下側開始, 上側開始, 上端 (省略時 4.9,9.3,10.3,14.7)",
    ),
    ("alpha", "相補フィルタでのジャイロの割合 0〜1 (省略時 0.98)"),
    ("gravity", "計測地の重力加速度 [m/s²]"),
    ("rest", "ジャイロのバイアスと初期姿勢を求める静止区間: auto、START:END [秒]、none"),
    ("relative", "ヨー・ピッチ・ロールの基準: 静止時に対する world 軸、body 軸、または none (そのまま)"),
    ("forward", "前方を向くセンサ軸 (±x, ±y, ±z)。開始時に水平へ投影した向きがワールドの x 軸になります"),
    ("calibration", "最初に記録へ適用するキャリブレーション"),
    ("apply.calibration", "適用するキャリブレーション"),
    ("degrees", "角度をラジアンではなく度で出力します"),
    ("keep", "入力のその他の列を出力に残します"),
    ("report", "レポートの出力先 (省略時は作業ディレクトリに、ほかの結果と同じ名前の .html)"),
    ("no_report", "レポートを出力しません"),
    ("plot", "ヨー・ピッチ・ロールの図も出力します"),
    ("force", "shisei が書いたものでないファイルも上書きします"),
    (
        "motion.force",
        "shisei が書いたものでないファイルも上書きし、位置をほとんど信頼できない場合 (長い間静止がない、サンプルが長く欠けている、終点が計測値と矛盾する) も計算を続けます",
    ),
    ("window", "six-face: 静止区間の長さ [秒] (省略時 3)"),
    ("step", "six-face: 探索の間隔 [秒] (省略時 0.1)"),
    ("max_tilt", "six-face: 各面の許容傾き [度] (省略時 15)"),
    ("var_threshold", "six-face: 静止とみなす分散の上限 [(m/s²)²] (省略時 0.01)"),
    (
        "method",
        "方法: six-face (6 面静止)、multi-pose (多姿勢から 9 パラメータ)、gyro-turns (ジャイロの行列も)",
    ),
    ("turns", "gyro-turns: 6 面静止と各軸 1 回の既知の回転の角度 [度]。負の値は符号どおりに扱います"),
    ("mode", "方法: rest-to-rest (静止から静止)、foot (足に付けた歩行)、naive (逐次積分のみ)"),
    ("scheme", "--mode naive での積分の順序 (省略時 semi-implicit)"),
    ("end", "最後の位置 X,Y,Z [m] が分かっている場合に指定します (rest-to-rest、foot)"),
    ("closed", "最後に最初の位置へ戻ったことを使います (rest-to-rest、foot)"),
    ("latitude", "計測地の緯度 [度] (北緯が正)"),
    (
        "headings",
        "各方向の方位 [度] (上から見て時計回り)。例 0,90,180,270。省略時はファイル名の _090deg から読みます",
    ),
    (
        "weights",
        "平均の重み: capped (長い欠落の後のサンプルを通常の 1 ステップとして数える) または article (記事のまま)",
    ),
    ("serial", "Spresense のスケッチが動くシリアルポート。計測を画面で案内します"),
    ("baud", "シリアルポートの速度"),
    ("directions", "--serial で計測する方向の数 (省略時 8)"),
    ("seconds", "--serial で 1 方向あたり平均する秒数 (省略時 65)"),
    ("sensor_id", "キャリブレーションに記録するセンサの名前"),
    ("ports", "問い合わせるシリアルポート。省略すると USB からレシーバを探します"),
    ("identify", "ノードを 10 秒間点滅させます (番号または all)"),
    ("recalibrate", "ノードのジャイロのバイアスを求め直します。2 秒間静止させてください"),
    ("rename", "ノードに 20 バイト以内の名前を付けます: 例 0=left-hand"),
    (
        "configure",
        "ノードの設定: フィルタ (complementary または estimator)、パケットあたりのサンプル数、°/s、g。例 0=estimator,4,2000,8",
    ),
    (
        "store_calibration",
        "ノードにキャリブレーションを保存します。ノードはフィルタの前に読み値を補正します。NODE=none で消去します",
    ),
    (
        "movement",
        "ノードの動き: free (自由な動き) または poses (6 面と多数の姿勢での静止。キャリブレーション用、112 秒)",
    ),
    ("kept_calibration", "ノードに最初から保存されているキャリブレーション。複数指定できます"),
    ("port", "レシーバのシリアルポート。その出力を保存したファイルも使えます"),
    ("for_s", "この秒数で終了します (省略時は Ctrl-C で終了)"),
    ("lab.for_s", "この秒数で終了します (省略時は Ctrl-C で終了。-o でファイルに書く場合は 60)"),
    ("wait", "切断されたポートの復帰を待つ時間 [秒]"),
    ("nodes", "ノードの数 (1〜6)"),
    ("seed", "乱数の種"),
    ("camera_rate", "カメラのフレームレート [Hz]"),
    ("gate", "記録ゲートが立ち上がる時刻 [秒] (省略時はゲートなし)"),
    ("missed", "受信できない接続イベントの割合 (0〜1)"),
    ("jitter", "アンカーポイントの標準偏差 [µs]"),
    ("skew", "時計のずれの最大値 [ppm]"),
    ("outage", "ノードが圏外になる時間 NODE:FROM:TO [秒]。複数指定できます"),
    ("reboot", "ノードが再起動する時刻 NODE:AT [秒]。複数指定できます"),
    ("natnet", "Motive のアドレス。HOST または HOST:PORT。auto でネットワーク上から探します"),
    (
        "natnet_out",
        "統合した剛体を Motive と同じ形式で既存のクライアントへ送ります。このコンピュータのアドレスとポート 2 つ (省略時 1510、1511)",
    ),
    (
        "natnet_multicast",
        "--natnet-out と併用します。そのアドレスのネットワークで、Motive の既定と同じくマルチキャストで送ります",
    ),
    ("osc", "姿勢を OSC (VMC のトラッカーとボーンを含む) で ADDR:PORT へ送ります"),
    ("replay", "記録をリアルタイムのように再生します。複数指定できます"),
    ("speed", "再生の速さ。1 は記録時のまま、0 は最高速です"),
    ("demo", "シミュレーションの実験室とカメラを使います。機器がなくても動作します"),
    ("record", "起動時から記録します。省略時、ビューアで開始した記録は shisei-live.mcap に保存されます"),
    (
        "lag",
        "記録される推定 /smoothed が続くデータを待つ時間 [秒]、0.5～3。その半分までの欠落は shisei fuse と同程度に補われます",
    ),
    (
        "listen",
        "ビューアのアドレス。ADDR または ADDR:PORT。このコンピュータ以外から開くには、表示されるトークンが必要です",
    ),
    ("optical_axes", "カメラの座標系: y-up (Motive の既定) または z-up"),
    ("pair", "ノードを付けた剛体を名前で指定します。省略時は動きから対応を求めます。複数指定できます"),
    ("alignment", "shisei fuse --json の出力。センサの取り付け方を使います"),
    ("help", "ヘルプを表示します"),
    ("version", "バージョンを表示します"),
];

fn text(table: &[(&str, &'static str)], id: &str) -> Option<&'static str> {
    table.iter().find(|(name, _)| *name == id).map(|(_, text)| *text)
}

/// The command line with Japanese help, at all levels.
pub fn localize(mut command: Command) -> Command {
    // Only what is built knows its own help option, the options of all commands, and its full name.
    command.build();
    level(command)
}

fn level(mut command: Command) -> Command {
    let usage = command.render_usage().to_string();
    let usage = usage.trim_start_matches("Usage:").trim();
    let usage = usage.replace("[OPTIONS]", "[オプション]").replace("<COMMAND>", "<コマンド>");
    let about = text(COMMANDS, command.get_name());
    let ids: Vec<String> = command.get_arguments().map(|arg| arg.get_id().to_string()).collect();
    let subcommands: Vec<String> = command.get_subcommands().map(|sub| sub.get_name().to_owned()).collect();
    let mut command = match about {
        Some(about) => command.about(about).long_about(about),
        None => command,
    };
    for id in ids {
        let own = format!("{}.{id}", command.get_name());
        let help = text(OPTIONS, &own).or_else(|| text(OPTIONS, &id));
        command = command.mut_arg(&id, |arg| argument(arg, help));
    }
    for name in subcommands {
        command = command.mut_subcommand(name, level);
    }
    command
        .override_usage(usage)
        .help_template("{about}\n\n使い方: {usage}\n\n{all-args}")
        .subcommand_help_heading("コマンド")
        .subcommand_value_name("コマンド")
}

/// Heading and help of an argument; what clap says in English about defaults and values is said here.
fn argument(arg: Arg, help: Option<&'static str>) -> Arg {
    let heading = if arg.is_positional() { "引数" } else { "オプション" };
    // Under a heading of one's own, arguments would be sorted by name.
    let order = arg.get_index();
    let arg = arg.help_heading(heading);
    let arg = order.into_iter().fold(arg, Arg::display_order);
    let Some(help) = help else { return arg };
    let names = |arg: &Arg| -> Vec<String> {
        let values = arg.get_possible_values();
        let shown = values.iter().filter(|value| !value.is_hide_set());
        shown.map(|value| value.get_name().to_owned()).collect()
    };
    let takes_value = arg.get_action().takes_values();
    let values = if takes_value { names(&arg) } else { Vec::new() };
    let default: Vec<_> = arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    let mut help = help.to_owned();
    if !values.is_empty() {
        help += &format!(" [値: {}]", values.join("、"));
    }
    if takes_value && !default.is_empty() {
        help += &format!(" [省略時: {}]", default.join("、"));
    }
    arg.hide_possible_values(true).hide_default_value(true).help(help.clone()).long_help(help)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::args::Cli;

    fn check_texts(command: &Command, missing: &mut Vec<String>) {
        if text(COMMANDS, command.get_name()).is_none() {
            missing.push(command.get_name().to_owned());
        }
        for arg in command.get_arguments() {
            let id = arg.get_id().as_str();
            let own = format!("{}.{id}", command.get_name());
            if text(OPTIONS, &own).or_else(|| text(OPTIONS, id)).is_none() {
                missing.push(format!("{} --{id}", command.get_name()));
            }
        }
        for sub in command.get_subcommands() {
            check_texts(sub, missing);
        }
    }

    #[test]
    fn every_command_and_option_has_a_japanese_text() {
        let mut missing = Vec::new();
        check_texts(&Cli::command(), &mut missing);
        assert!(missing.is_empty(), "without Japanese text: {missing:?}");
    }

    #[test]
    fn japanese_command_line_is_consistent() {
        localize(Cli::command()).debug_assert();
    }

    fn check_words(command: &mut Command, wrong: &mut Vec<String>) {
        for help in [command.render_help().to_string(), command.render_long_help().to_string()] {
            for word in [
                "Usage",
                "Options",
                "OPTIONS",
                "Commands",
                "COMMAND",
                "Arguments",
                "default",
                "possible",
                "Print",
            ] {
                if help.contains(word) {
                    wrong.push(format!("{}: {word}", command.get_name()));
                }
            }
            assert!(help.contains("使い方: shisei") && help.contains("オプション:"), "{help}");
        }
        command.get_subcommands_mut().for_each(|sub| check_words(sub, wrong));
    }

    #[test]
    fn headings_are_japanese_at_all_levels() {
        let (mut wrong, mut command) = (Vec::new(), localize(Cli::command()));
        check_words(&mut command, &mut wrong);
        assert!(wrong.is_empty(), "English in Japanese help: {wrong:?}");
        let lab = command.find_subcommand_mut("simulate").and_then(|sub| sub.find_subcommand_mut("lab"));
        let lab = lab.expect("simulate lab").render_help().to_string();
        assert!(lab.contains("使い方: shisei simulate lab [オプション]"), "{lab}");
        assert!(lab.contains("[値: free、poses] [省略時: free]"), "{lab}");
        let fuse = command.find_subcommand_mut("fuse").expect("fuse").render_help().to_string();
        let place = |word: &str| fuse.rfind(&format!("\n  {word}")).expect(word);
        assert!(place("<OPTICAL.csv>") < place("<IMU.csv>..."), "{fuse}");
    }
}
