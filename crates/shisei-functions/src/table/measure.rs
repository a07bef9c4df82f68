//! Long measurements at rest: Allan deviation, and the Earth's rotation.

use crate::error::Result;
use crate::function::{Function, function};
use crate::input::{Series, SixColumns};
use crate::output::{Rows, Table};
use shisei_core::allan::{averaging_factors, curve};
use shisei_core::earth::analysis::analyse;
use shisei_core::earth::direction::Direction;
use shisei_core::earth::fits::Measured;

/// Averaging times a decade.
const PER_DECADE: usize = 10;

pub(super) const ALLAN_DEV: Function = function! {
    "AllanDev" = GetAllanDeviation in Extra, "=AllanDev(E2:E100001,0.01)";
    "Overlapping Allan deviation of one axis at rest: how much averaging helps. Averaging times are ten a decade, \
     up to a third of the recording, each with its 68 % interval; plot both axes logarithmically."
        / "静止させた 1 軸の重複アラン偏差を求めます。平均時間は 1 桁あたり 10 点、記録の長さの 1/3 までで、68 % 信頼区間を\
           付けます。両対数グラフにすると、平均の効果がわかります。";
    (data: Series<'_, 1>, [""] "readings" / "計測値":
        "N×1, one axis at rest in any unit, without gaps" / "N 行 1 列、静止させた 1 軸 (単位は任意、欠落なし)";
    dt: f64, ["s"] "sample interval" / "サンプル間隔": "time from row to row" / "行と行の時間間隔";)
    -> Rows<4>, "averaging time s; deviation; lower and upper end of its 68 % interval, in the unit of the data"
        / "平均時間 (s)、アラン偏差、その 68 % 信頼区間の下限と上限 (データと同じ単位)";
    example ALLAN_DEV;
    {
        let rate = data.rows.as_flattened();
        let points = curve(rate, dt, &averaging_factors(rate.len(), PER_DECADE))?;
        Rows(points.iter().map(|p| [p.tau_s, p.deviation, p.low, p.high]).collect())
    }
};

pub(super) const EARTH_RATE: Function = function! {
    "EarthRate" = GetEarthRate in Extra, "=EarthRate(A2:C9,0.61)";
    "The Earth's rotation from mean rates in several directions, with standard errors, by the fit that the directions \
     allow; #N/A where they determine nothing. FitSphere gives the plain sphere."
        / "複数の方向で測った角速度の平均から、地球の自転を標準誤差とともに求めます。方向の配置に応じて適切な当てはめを\
           選び、決まらない値は #N/A になります。単純な球の当てはめは FitSphere です。";
    (means: SixColumns<'_>, ["(m/s²,) rad/s"] "mean readings" / "平均値":
        "N×3: mean gyroX, Y, Z, one direction a row; N×6: mean accX, Y, Z before them"
        / "N 行 3 列: 1 方向 1 行のジャイロ平均 x, y, z。N 行 6 列: その前に加速度平均 x, y, z";
    latitudeRad: f64 = 0.0, ["rad"] "latitude" / "緯度":
        "latitude of the place, north positive; 0: not known" / "計測地の緯度 (北緯が正)。0 は不明";)
    -> Table<4, 2>, "rows: rate rad/s, its horizontal part rad/s, latitude rad, sidereal day h; columns: value, standard error"
        / "行は自転角速度 (rad/s)、その水平成分 (rad/s)、緯度 (rad)、恒星日 (h)。列は値と標準誤差";
    example EARTH_RATE;
    earth_rate(&means, latitudeRad)?
};

fn earth_rate(means: &SixColumns<'_>, latitude_rad: f64) -> Result<Table<4, 2>> {
    let directions: Vec<Direction> = match means {
        SixColumns::Three(series) => {
            series.rows.iter().map(|&gyro_rad_s| Direction { gyro_rad_s, ..Direction::default() }).collect()
        }
        SixColumns::Six(series) => series
            .rows
            .iter()
            .map(|&[ax, ay, az, gx, gy, gz]| Direction {
                gyro_rad_s: [gx, gy, gz],
                acc_m_s2: Some([ax, ay, az]),
                ..Direction::default()
            })
            .collect(),
    };
    let latitude = (latitude_rad != 0.0).then_some(latitude_rad);
    let found = analyse(&directions, latitude)?;
    let row = |measured: Option<Measured>| measured.map_or([f64::NAN; 2], |m| [m.value, m.sigma]);
    Ok(Table([row(found.rate), row(found.horizontal), row(found.latitude), row(found.day_h)]))
}
