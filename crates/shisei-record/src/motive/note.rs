//! What a take lacks: it can be used, but its owner must know.

use crate::Warning;

/// The last row, at this line of the file from 1, was left out.
pub(super) fn cut_row(line: usize) -> Warning {
    Warning::new(
        "take-cut",
        format!(
            "the take's last row (line {line}) ends in its middle and was left out: the file was cut off; export or \
             copy it again"
        ),
        format!(
            "テイクの最後の行 ({line} 行目) が途中で終わっているため、使いませんでした。ファイルが途中で切れています。\
             書き出すかコピーし直してください"
        ),
    )
}

/// There is another number of rows than Total Exported Frames.
pub(super) fn count(rows: usize, told: u64) -> Warning {
    Warning::new(
        "take-count",
        format!(
            "the take has {rows} frames, and its first row says {told} (Total Exported Frames); export it again if \
             frames are missing"
        ),
        format!(
            "テイクのフレームは {rows} 個ですが、先頭行では {told} 個です (Total Exported Frames)。\
             欠けている場合は書き出し直してください"
        ),
    )
}

/// So many frame numbers are left out, the first after this frame.
pub(super) fn missing(frames: u64, after: i64) -> Warning {
    Warning::new(
        "take-frames-missing",
        format!(
            "{frames} frame numbers are missing from the take, the first after frame {after}; nothing is filled in there"
        ),
        format!(
            "テイクにフレーム番号が {frames} 個ありません (最初はフレーム {after} の次)。その部分は補いません"
        ),
    )
}

/// So many cells of the time column go back, the first at this frame.
pub(super) fn time_back(cells: usize, frame: i64) -> Warning {
    Warning::new(
        "take-time-back",
        format!(
            "the take's time column goes back at frame {frame} ({cells} in all); those cells are taken as blank, and \
             time is counted by frame numbers"
        ),
        format!(
            "テイクの時刻の列がフレーム {frame} で戻っています (計 {cells} 個)。そのセルは空白とみなし、\
             時刻はフレーム番号から求めます"
        ),
    )
}
