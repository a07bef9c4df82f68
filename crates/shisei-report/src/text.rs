//! The words of the reports, in English and in Japanese.

use shisei_core::Lang;

macro_rules! texts {
    ($($name:ident: $en:literal, $ja:literal;)*) => {
        /// Every word that a report says by itself.
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct Text {
            $(pub $name: &'static str,)*
        }

        impl Text {
            /// In a language.
            pub(crate) const fn of(lang: Lang) -> Text {
                match lang {
                    Lang::En => Text { $($name: $en,)* },
                    Lang::Ja => Text { $($name: $ja,)* },
                }
            }
        }
    };
}

texts! {
    html_lang: "en", "ja";
    summary: "Summary", "概要";
    warnings: "Please note", "ご注意ください";
    assumptions: "What was assumed", "前提としたこと";
    and_more: "… and {n} more", "… ほか {n} 件";
    no_script: "The plots and the 3-D view need JavaScript, which is switched off here. The tables can be read without.",
        "グラフと立体表示には JavaScript が必要ですが、無効になっています。表はこのままお読みいただけます。";
    offline_note: "This page works offline and sends nothing.",
        "このページはオフラインで動作し、何も送信しません。";
    zoom: "Zoom", "拡大・縮小";
    zoom_in: "Zoom in", "拡大";
    zoom_out: "Zoom out", "縮小";
    earlier: "Earlier", "前へ";
    later: "Later", "後へ";
    whole: "Whole recording", "全体を表示";
    hint: "Drag over a plot to zoom in, double-click to see everything again; Ctrl + wheel zooms about the pointer. All plots move together. Click a name to hide or show its line.",
        "グラフ上をドラッグすると拡大、ダブルクリックで全体表示に戻ります。Ctrl + ホイールでポインターの位置を中心に拡大・縮小できます。すべてのグラフは連動します。名前をクリックすると線の表示・非表示を切り替えられます。";
    attitude: "Attitude", "姿勢";
    attitude_description: "The sensor as a box in the world frame, z up, at the time of the cursor",
        "カーソルの時刻におけるセンサの姿勢。z 軸を上とする世界座標系に箱で示します";
    attitude_hint: "The box is the sensor, its axes as marked on it; the grid is level. Drag, or press the arrow keys, to look from elsewhere. On the time slider: arrow keys 0.1 s, with Shift 1 s; Space plays.",
        "箱がセンサ、x・y・z はセンサの軸、格子は水平面です。ドラッグまたは矢印キーで視点を変えられます。時刻スライダー: 矢印キーで 0.1 秒、Shift を押しながらで 1 秒、スペースキーで再生します。";
    play: "Play", "再生";
    pause: "Pause", "一時停止";
    speed: "Speed", "速度";
    time: "Time", "時刻";
    rest: "at rest", "静止区間";
    gap: "no samples", "欠測";
    poor: "poor estimate", "推定が不確か";
    band: "±1 σ", "±1 σ";
    thinned: "{n} of {m} samples are drawn; every peak is kept.",
        "{m} 点のうち {n} 点を描画しています (極大・極小はすべて残しています)。";
    hide: "Hide {name}", "{name} を隠す";
    show: "Show {name}", "{name} を表示する";
    yaw: "Yaw", "ヨー";
    pitch: "Pitch", "ピッチ";
    roll: "Roll", "ロール";
    orientation: "Yaw, pitch, roll", "ヨー・ピッチ・ロール";
    angle: "Angle", "角度";
    acceleration: "Acceleration", "加速度";
    angular_rate: "Angular rate (gyroscope)", "角速度 (ジャイロ)";
    angular_rate_axis: "Angular rate", "角速度";
    plot_of: "{what} over time, from {from} s to {to} s", "{from} 秒から {to} 秒までの{what}";
    ranges: "Range of the angles", "角度の範囲";
    smallest: "smallest", "最小";
    largest: "largest", "最大";
    at_end: "at the end", "終了時";
    seconds: "s", "秒";
    at_time: "{value} at {time} s", "{value} ({time} 秒)";
}
