//! The sentences of [`Problem`], in English and in Japanese.

use crate::error::{Problem, shorten};

/// At most twelve names, each shortened, joined by commas.
pub(crate) fn list(names: &[String]) -> String {
    let mut out = String::new();
    for (i, name) in names.iter().take(12).enumerate() {
        if i > 0 {
            out.push_str(", ");
        }
        out.push_str(&shorten(name));
    }
    if names.len() > 12 {
        out.push_str(", …");
    }
    out
}

/// The columns of Motive's tracking CSV.
fn is_a_take(columns: &[String]) -> bool {
    columns.iter().any(|name| ["Rigid Body ", "Bone ", "Marker "].iter().any(|kind| name.starts_with(kind)))
        && columns.iter().any(|name| name.ends_with("Position X"))
}

pub(crate) fn english(problem: &Problem) -> String {
    match problem {
        Problem::Empty => "the file is empty; expected a recording with a header and rows of numbers; check \
                           that the logger wrote it and copy it again"
            .into(),
        Problem::HeaderOnly => {
            "there is a header and no row of numbers after it; record again or choose another file".into()
        }
        Problem::TooFewRows { rows } => {
            format!("the recording has {rows} row(s); at least 2 are needed; record for longer")
        }
        Problem::NotText => {
            "this is neither a text table nor a known binary recording; expected CSV, Parquet \
                             or one of these in gzip; export the recording as CSV"
                .into()
        }
        Problem::OtherFormat { format } => {
            format!("this is {format}, which is not read here; export the recording as CSV")
        }
        Problem::LineTooLong { limit } => format!(
            "the line is longer than {} KiB; expected one sample a line; check that this is a recording",
            limit / 1024
        ),
        Problem::NoTable => "no table of numbers was found in the text; expected a header and one sample a \
                             line; check that this is a recording, or name its columns with --columns"
            .into(),
        Problem::Grouped { text } => format!(
            "the number {text} has a sign between its thousands, which would be read as a decimal sign; have the numbers \
             written without it (in a spreadsheet: the format General), and save again"
        ),
        Problem::Unsorted { count, rows } => format!(
            "the time of {count} of {rows} rows is before that of an earlier row; sort the rows by time, or give another \
             time column with --columns, or the rate with --rate"
        ),
        Problem::NotARecording { columns } if is_a_take(columns) => {
            "this is a motion capture take, not the recording of a sensor; give both to shisei fuse".into()
        }
        Problem::NotARecording { columns } => format!(
            "this table is no recording of a motion sensor: none of its columns ({}) is an acceleration or \
             an angular rate; if some are, name them with --columns",
            list(columns)
        ),
        Problem::MissingColumn { missing, columns } => format!(
            "{} could not be found among the columns ({}); three axes of acceleration and three of angular \
             rate are needed; name them with --columns",
            list(missing),
            list(columns)
        ),
        Problem::NoGyro { columns } => format!(
            "there is no angular rate (gyroscope) among the columns ({}); attitude cannot be followed \
             without it; record with the gyroscope on, or give its file together with this one",
            list(columns)
        ),
        Problem::NoAcc { columns } => format!(
            "there is no acceleration among the columns ({}); give the accelerometer's file together with \
             this one",
            list(columns)
        ),
        Problem::GravityRemoved { column, norm_m_s2 } => match norm_m_s2 {
            Some(norm) if (0.8..=1.25).contains(norm) => format!(
                "|a| at rest is {norm:.3} m/s² where about 9.8 is expected, which is what readings in g would be; \
                 name the unit with --units acc=g"
            ),
            Some(norm) => format!(
                "|a| at rest is {norm:.3} m/s² where about 9.8 is expected: gravity was removed from the \
                 acceleration, or other columns were taken for it; gravity is what tells up from down; export the \
                 raw accelerometer (with gravity), or name the columns with --columns"
            ),
            None => format!(
                "gravity was removed from the acceleration (\"{}\" is acceleration without gravity); gravity is \
                 what tells up from down; export the raw accelerometer (with gravity)",
                shorten(column)
            ),
        },
        Problem::RawCounts { norm } => format!(
            "the values are raw counts of the sensor (|a| at rest is about {norm:.0}); say what a count is \
             with --scale acc=COUNTS_PER_G,gyr=COUNTS_PER_DEG_S (for example acc=16384,gyr=131), or give a \
             calibration that takes counts"
        ),
        Problem::UnitUnclear { norm } => format!(
            "the unit of the acceleration is not written and |a| at rest ({norm:.4}) fits none of 1 g, 9.8 \
             m/s² and 1000 mg; name it with --units acc=g (or m/s2, mg) or --scale"
        ),
        Problem::RateNeeded => "the file has no usable time column and no sampling rate; give the rate in \
                                hertz with --rate, for example --rate 100"
            .into(),
        Problem::ManySensors { names } => format!(
            "there is more than one sensor in the file: {}; choose one with --sensor NAME",
            list(names)
        ),
        Problem::NoSamples => {
            "this recording holds no readings of a motion sensor (sensor_msgs/msg/Imu): nothing \
                               readable came from the receiver while it was made, or it is of other things"
                .into()
        }
        Problem::NoSuchSensor { asked, names } => format!(
            "there is no sensor \"{}\"; the file has: {}; choose one of them with --sensor",
            shorten(asked),
            list(names)
        ),
        Problem::NoSuchColumn { asked, columns } => format!(
            "there is no column \"{}\"; the file has: {}; name one of them, or its number from 1",
            shorten(asked),
            list(columns)
        ),
        Problem::NotANumber { text } => {
            format!(
                "\"{text}\" is not a number; repair the cell, or leave such rows out with --skip-bad-rows"
            )
        }
        Problem::NotFinite { text } => format!(
            "\"{text}\" is not a finite number; repair the cell, or leave such rows out with --skip-bad-rows"
        ),
        Problem::Blank => {
            "the cell is blank where a number is needed; fill it, or leave such rows out with --skip-bad-rows"
                .into()
        }
        Problem::ShortRow { cells, needed } => format!(
            "the row has {cells} cell(s) and {needed} are needed; repair it, or leave such rows out with \
             --skip-bad-rows"
        ),
        Problem::BadStamp { text } => format!(
            "\"{text}\" cannot be read as a time; expected seconds, a date with a time, or mm:ss; repair it, \
             or give --rate to leave the stamps aside"
        ),
        Problem::BadOption { option, value, expected } => {
            format!("{option} \"{value}\" cannot be read; expected for example {expected}")
        }
        Problem::Damaged { format, detail } => {
            format!("the {format} data are damaged or cut off ({detail}); copy the file again")
        }
        Problem::Compression { codec } => format!(
            "the Parquet data are compressed with {codec}, which is not read here; write the file again with snappy, \
             zstd, gzip, lz4 or without compression"
        ),
        Problem::Unreadable { detail } => format!("it cannot be read ({detail})"),
        Problem::TooLarge { limit } => format!(
            "unpacked, the file is larger than {} MiB; unpack it yourself if it is what you expect, and \
             split it",
            limit / (1024 * 1024)
        ),
        Problem::NoOverlap => {
            "the files given together share no stretch of time; give the accelerometer and \
                               gyroscope files of one recording"
                .into()
        }
        Problem::SameQuantity { quantity } => format!(
            "another file given with it already holds {quantity}; give one file for the accelerometer and \
             one for the gyroscope"
        ),
    }
}

pub(crate) fn japanese(problem: &Problem) -> String {
    match problem {
        Problem::Empty => {
            "ファイルが空です。見出しと数値の行が必要です。記録が正しく保存されているか確認し、\
                           もう一度コピーしてください"
                .into()
        }
        Problem::HeaderOnly => {
            "見出しだけで、数値の行がありません。記録し直すか、別のファイルを指定してください".into()
        }
        Problem::TooFewRows { rows } => {
            format!("記録が {rows} 行しかありません (2 行以上必要)。もっと長く記録してください")
        }
        Problem::NotText => "テキストの表でも既知の記録形式でもありません。CSV、Parquet、またはその gzip \
                             を指定してください。CSV で書き出してください"
            .into(),
        Problem::OtherFormat { format } => {
            format!("このファイルは {format} で、ここでは読めません。CSV で書き出してください")
        }
        Problem::LineTooLong { limit } => format!(
            "1 行が {} KiB を超えています。1 行に 1 サンプルの記録かどうか確認してください",
            limit / 1024
        ),
        Problem::NoTable => {
            "数値の表が見つかりません。見出しと、1 行 1 サンプルの数値が必要です。記録かどうか\
                             確認するか、--columns で列を指定してください"
                .into()
        }
        Problem::Grouped { text } => format!(
            "数値 {text} に桁区切りがあり、小数点と区別できません。桁区切りのない形 (表計算では表示形式「標準」) にして保存し直して\
             ください"
        ),
        Problem::Unsorted { count, rows } => format!(
            "{rows} 行のうち {count} 行の時刻が、前の行より前に戻っています。時刻の順に並べ替えるか、--columns で別の時刻の列を、\
             または --rate でサンプリング周波数を指定してください"
        ),
        Problem::NotARecording { columns } if is_a_take(columns) => {
            "モーションキャプチャのテイクで、センサの記録ではありません。両方を shisei fuse に指定してください".into()
        }
        Problem::NotARecording { columns } => format!(
            "この表はモーションセンサの記録ではありません。列 ({}) に加速度も角速度もありません。あるなら \
             --columns で指定してください",
            list(columns)
        ),
        Problem::MissingColumn { missing, columns } => format!(
            "{} が列 ({}) に見つかりません。加速度 3 軸と角速度 3 軸が必要です。--columns で指定してください",
            list(missing),
            list(columns)
        ),
        Problem::NoGyro { columns } => format!(
            "列 ({}) に角速度 (ジャイロ) がありません。これがないと姿勢を追えません。ジャイロを有効にして記録\
             するか、ジャイロのファイルを一緒に指定してください",
            list(columns)
        ),
        Problem::NoAcc { columns } => {
            format!("列 ({}) に加速度がありません。加速度のファイルを一緒に指定してください", list(columns))
        }
        Problem::GravityRemoved { column, norm_m_s2 } => match norm_m_s2 {
            Some(norm) if (0.8..=1.25).contains(norm) => format!(
                "静止時の |a| が約 9.8 ではなく {norm:.3} m/s² で、g 単位の値と考えられます。--units acc=g で単位を\
                 指定してください"
            ),
            Some(norm) => format!(
                "静止時の |a| が約 9.8 ではなく {norm:.3} m/s² です。加速度から重力が除かれているか、別の列が加速度と\
                 みなされています。上下を決めるには重力が必要です。重力を含む加速度を書き出すか、--columns で列を\
                 指定してください"
            ),
            None => format!(
                "加速度から重力が除かれています (「{}」は重力を除いた加速度です)。上下を決めるには重力が必要です。\
                 重力を含む加速度を書き出してください",
                shorten(column)
            ),
        },
        Problem::RawCounts { norm } => format!(
            "値はセンサの生カウントです (静止時の |a| は約 {norm:.0})。--scale \
             acc=1gあたりのカウント,gyr=1deg/sあたりのカウント (例: acc=16384,gyr=131) を指定するか、\
             カウント用のキャリブレーションを指定してください"
        ),
        Problem::UnitUnclear { norm } => format!(
            "加速度の単位が書かれておらず、静止時の |a| ({norm:.4}) は 1 g、9.8 m/s²、1000 mg のどれにも\
             合いません。--units acc=g (または m/s2, mg) か --scale で指定してください"
        ),
        Problem::RateNeeded => {
            "使える時刻の列もサンプリング周波数もありません。--rate 100 のように Hz で指定\
                                してください"
                .into()
        }
        Problem::ManySensors { names } => {
            format!("ファイルに複数のセンサがあります: {}。--sensor 名前 で 1 つ選んでください", list(names))
        }
        Problem::NoSamples => {
            "この記録にはモーションセンサの値 (sensor_msgs/msg/Imu) がありません。記録中にレシーバから読める\
                               データが届かなかったか、別の種類の記録です"
                .into()
        }
        Problem::NoSuchSensor { asked, names } => format!(
            "センサ「{}」はありません。ファイルにあるのは {} です。--sensor でこの中から選んでください",
            shorten(asked),
            list(names)
        ),
        Problem::NoSuchColumn { asked, columns } => format!(
            "列「{}」はありません。ファイルにあるのは {} です。この中の名前か、1 から数えた番号を指定してください",
            shorten(asked),
            list(columns)
        ),
        Problem::NotANumber { text } => {
            format!("「{text}」は数値ではありません。セルを直すか、--skip-bad-rows でその行を除いてください")
        }
        Problem::NotFinite { text } => format!(
            "「{text}」は有限の数値ではありません。セルを直すか、--skip-bad-rows でその行を除いてください"
        ),
        Problem::Blank => {
            "数値が必要なセルが空です。値を入れるか、--skip-bad-rows でその行を除いてください".into()
        }
        Problem::ShortRow { cells, needed } => format!(
            "この行は {cells} セルしかありません ({needed} セル必要)。直すか、--skip-bad-rows で除いてください"
        ),
        Problem::BadStamp { text } => format!(
            "「{text}」を時刻として読めません。秒、日付と時刻、または mm:ss が必要です。直すか、--rate を指定\
             して時刻の列を使わないようにしてください"
        ),
        Problem::BadOption { option, value, expected } => {
            format!("{option} の「{value}」を読めません。例: {expected}")
        }
        Problem::Damaged { format, detail } => {
            format!(
                "{format} のデータが壊れているか途中で切れています ({detail})。もう一度コピーしてください"
            )
        }
        Problem::Compression { codec } => format!(
            "Parquet のデータが {codec} で圧縮されており、ここでは読めません。snappy、zstd、gzip、lz4、または無圧縮で\
             書き出し直してください"
        ),
        Problem::Unreadable { detail } => format!("読み取れません ({detail})"),
        Problem::TooLarge { limit } => format!(
            "展開すると {} MiB を超えます。想定どおりなら自分で展開し、分割してください",
            limit / (1024 * 1024)
        ),
        Problem::NoOverlap => {
            "一緒に指定されたファイルに共通の時間帯がありません。同じ記録の加速度とジャイロの\
                               ファイルを指定してください"
                .into()
        }
        Problem::SameQuantity { quantity } => format!(
            "一緒に指定された別のファイルにも {quantity} があります。加速度 1 つ、ジャイロ 1 つを指定してください"
        ),
    }
}
