//! From the meanings of columns to the six that are read.

use crate::error::{Error, Place, Problem, Result};
use crate::names::{self, Grade, Meaning, Quantity};
use crate::number::{self, Cell};
use crate::options::{ColumnRef, Options};
use crate::recording::{Channel, Note};
use crate::sheet::Sheet;
use crate::stated_rate;
use crate::units::Unit;

/// What a dialect knows about a sheet; the generic reading of the names, to be mended by the dialect.
#[derive(Debug, Default)]
pub struct Reading {
    /// Meaning of each column.
    pub meanings: Vec<Meaning>,
    /// Rate that the preamble or the kind of file states, Hz.
    pub rate_hz: Option<f64>,
    /// Unit of the acceleration where the header has none.
    pub acc_unit: Option<Unit>,
    /// Unit of the angular rate where the header has none.
    pub gyro_unit: Option<Unit>,
    /// Unit of the time column where the header has none.
    pub time_unit: Option<Unit>,
    /// Raw time starts again at this value (in raw units).
    pub time_cycle: Option<f64>,
    /// A coarser time that settles whole cycles of the time column.
    pub coarse_time: Option<CoarseTime>,
    /// Unit of the angular rate to fall back on where the values do not tell.
    pub gyro_guess: Option<Unit>,
    /// What was decided.
    pub assumptions: Vec<Note>,
    /// What to know.
    pub warnings: Vec<Note>,
}

/// A column of whole seconds beside one of their parts.
#[derive(Clone, Copy, Debug)]
pub struct CoarseTime {
    pub column: usize,
    /// The two are parts of one number. Else they may roll over apart.
    pub exact: bool,
}

impl Reading {
    /// The names of a sheet as the generic resolver reads them.
    pub fn of(sheet: &Sheet<'_>) -> Self {
        let names = sheet.column_names();
        let mut meanings: Vec<Meaning> = (0..names.len())
            .map(|i| {
                let unit = sheet.units.get(i).map_or("", String::as_str);
                if sheet.header.is_empty() {
                    return Meaning::other();
                }
                names::meaning(names.get(i).map_or("", String::as_str), unit)
            })
            .collect();
        one_based_axes(&mut meanings);
        let mut out = Reading { meanings, rate_hz: stated_rate::find(&sheet.preamble), ..Reading::default() };
        bare_axes(sheet, &mut out);
        out
    }
}

/// Axes counted 1, 2, 3 become 0, 1, 2.
fn one_based_axes(meanings: &mut [Meaning]) {
    for quantity in [Quantity::Acceleration, Quantity::AngularRate] {
        let of = |m: &Meaning| m.quantity == quantity;
        if meanings.iter().any(|m| of(m) && m.axis == Some(3)) {
            for m in meanings.iter_mut().filter(|m| of(m)) {
                m.axis = m.axis.and_then(|a| a.checked_sub(1));
            }
        }
    }
}

/// Columns that name only an axis take their quantity from the file's name; a file named after a part of
/// the acceleration (linear, gravity) says so for its acceleration.
fn bare_axes(sheet: &Sheet<'_>, reading: &mut Reading) {
    let stem = sheet.name.rsplit(['/', '\\']).next().unwrap_or(sheet.name);
    let stem = stem.split('.').next().unwrap_or(stem);
    let said = names::meaning(&format!("{stem} x"), "");
    for m in reading.meanings.iter_mut().filter(|m| !m.named && m.axis.is_some()) {
        match (m.quantity, said.quantity) {
            (Quantity::Axis, quantity) => {
                m.quantity = quantity;
                m.grade = said.grade;
            }
            (Quantity::Acceleration, Quantity::LinearAcceleration | Quantity::Gravity) => {
                m.quantity = said.quantity;
            }
            _ => {}
        }
    }
}

/// Three columns of one quantity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Triple {
    pub columns: [usize; 3],
    pub unit: Option<Unit>,
    pub label: String,
    pub grade: Grade,
}

/// What is read from a sheet.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    pub time: Option<usize>,
    pub time_unit: Option<Unit>,
    pub counter: Option<usize>,
    pub acc: Option<Triple>,
    pub gyro: Option<Triple>,
    pub temp: Option<usize>,
    pub keep: Vec<usize>,
    /// Name of a column that is acceleration without gravity, where no other acceleration is there.
    pub without_gravity: Option<String>,
    /// Acceleration without gravity and the gravity alone: their sum is the acceleration.
    pub linear: Option<Triple>,
    /// See `linear`.
    pub gravity: Option<Triple>,
}

impl Plan {
    /// Chooses columns; an error where the choice needs the user, not where a quantity is absent.
    pub fn make(sheet: &Sheet<'_>, reading: &Reading, options: &Options) -> Result<Plan> {
        let names = sheet.column_names();
        let mut plan = Plan { time: best_time(sheet, reading), ..Plan::default() };
        plan.counter = column_of(reading, Quantity::Counter).into_iter().find(|c| numeric(sheet, *c));
        plan.temp = column_of(reading, Quantity::Temperature).into_iter().find(|c| numeric(sheet, *c));
        let given = match &options.columns {
            Some(columns) => resolve(sheet, &names, &columns.roles)?,
            None => [None; 8],
        };
        let acc = triples(reading, Quantity::Acceleration, given_axes(&given, 1).is_none());
        let gyro = triples(reading, Quantity::AngularRate, given_axes(&given, 4).is_none());
        choose_sensors(sheet, &mut plan, acc, gyro, options)?;
        if plan.acc.is_none() {
            plan.without_gravity = reading
                .meanings
                .iter()
                .position(|m| m.quantity == Quantity::LinearAcceleration && m.axis.is_some())
                .and_then(|i| names.get(i).cloned());
            plan.linear = triples(reading, Quantity::LinearAcceleration, true).into_iter().next();
            plan.gravity = triples(reading, Quantity::Gravity, true).into_iter().next();
        }
        apply_given(&mut plan, reading, &given);
        if plan.acc.is_none() || plan.gyro.is_none() {
            check_partial(sheet, reading, &plan, &names)?;
        }
        if let Some(column) = plan.time {
            plan.time_unit =
                reading.meanings.get(column).and_then(|m| m.unit).filter(|u| matches!(u, Unit::Time(..)));
        }
        plan.keep = plan.kept(&names, &options.keep, sheet)?;
        Ok(plan)
    }

    /// The columns to keep; `*` is those that nothing else is read from.
    fn kept(&self, names: &[String], keep: &[String], sheet: &Sheet<'_>) -> Result<Vec<usize>> {
        if keep.iter().any(|asked| asked == "*") {
            return Ok((0..names.len()).filter(|column| self.role(*column).is_none()).collect());
        }
        keep.iter().map(|asked| find(sheet, names, asked)).collect()
    }

    /// What a column is used for.
    fn role(&self, column: usize) -> Option<String> {
        if self.time == Some(column) {
            return Some("time_s".into());
        }
        let summed = self.acc.is_none() && self.linear.is_some() && self.gravity.is_some();
        let parts = if summed { [&self.linear, &self.gravity] } else { [&None; 2] };
        for (triple, prefix) in
            [(&self.acc, "acc"), (&self.gyro, "gyr"), (parts[0], "acc"), (parts[1], "acc")]
        {
            if let Some(axis) = triple.as_ref().and_then(|t| t.columns.iter().position(|c| *c == column)) {
                return Some(format!("{prefix}_{}", ["x", "y", "z"][axis]));
            }
        }
        (self.temp == Some(column)).then(|| "temp_c".into())
    }

    /// The sheet's columns and what they are taken for.
    pub fn channels(&self, sheet: &Sheet<'_>, reading: &Reading) -> Vec<Channel> {
        sheet
            .column_names()
            .into_iter()
            .enumerate()
            .map(|(i, name)| {
                let meaning = reading.meanings.get(i).cloned().unwrap_or_else(Meaning::other);
                let used = self.role(i);
                let seems = match meaning.quantity {
                    Quantity::Acceleration => "acceleration",
                    Quantity::LinearAcceleration => "acceleration without gravity",
                    Quantity::Gravity => "gravity",
                    Quantity::AngularRate => "angular rate",
                    Quantity::Temperature => "temperature",
                    Quantity::Time => "time",
                    Quantity::Counter => "counter",
                    Quantity::Axis => "axis of an unnamed quantity",
                    Quantity::Other => "other",
                };
                let unit = meaning
                    .unit
                    .map_or_else(|| sheet.units.get(i).cloned().unwrap_or_default(), |u| u.name().to_owned());
                Channel {
                    number: i + 1,
                    file: sheet.name.to_owned(),
                    name,
                    unit,
                    used: used.is_some(),
                    role: used.unwrap_or_else(|| seems.to_owned()),
                }
            })
            .collect()
    }
}

fn column_of(reading: &Reading, quantity: Quantity) -> Vec<usize> {
    (0..reading.meanings.len())
        .filter(|i| reading.meanings.get(*i).is_some_and(|m| m.quantity == quantity))
        .collect()
}

/// True when the column's first cells are numbers.
fn numeric(sheet: &Sheet<'_>, column: usize) -> bool {
    let mut cells =
        sheet.sample.iter().filter_map(|r| r.get(column)).filter(|c| !c.trim().is_empty()).peekable();
    cells.peek().is_some()
        && cells.all(|c| matches!(number::cell(c.as_bytes(), sheet.decimal), Cell::Number(_)))
}

/// The time column: numbers with a unit before numbers without, before text; one that stands still last.
fn best_time(sheet: &Sheet<'_>, reading: &Reading) -> Option<usize> {
    let rank = |column: usize| -> Option<u32> {
        let cells: Vec<&str> = sheet
            .sample
            .iter()
            .filter_map(|r| r.get(column))
            .map(|c| c.trim())
            .filter(|c| !c.is_empty())
            .collect();
        let first = cells.first()?;
        let meaning = reading.meanings.get(column)?;
        let still = cells.iter().all(|c| c == first) && cells.len() > 1;
        let text = !numeric(sheet, column);
        if text && crate::stamp::parse(first.as_bytes()).is_none() {
            return None;
        }
        Some(
            u32::from(still) * 8
                + u32::from(text) * 4
                + u32::from(meaning.unit.is_none()) * 2
                + u32::from(!meaning.label.is_empty()),
        )
    };
    column_of(reading, Quantity::Time).into_iter().filter_map(|c| Some((rank(c)?, c))).min().map(|(_, c)| c)
}

/// The complete triples of a quantity; none where none is wanted.
fn triples(reading: &Reading, quantity: Quantity, wanted: bool) -> Vec<Triple> {
    if !wanted {
        return Vec::new();
    }
    let mut groups: Vec<(String, Grade, [Option<usize>; 3])> = Vec::new();
    for (column, m) in reading.meanings.iter().enumerate() {
        let Some(axis) = m.axis.map(usize::from).filter(|a| *a < 3 && m.quantity == quantity) else {
            continue;
        };
        let free = groups
            .iter_mut()
            .find(|(label, grade, axes)| *label == m.label && *grade == m.grade && axes[axis].is_none());
        if let Some((_, _, axes)) = free {
            axes[axis] = Some(column);
        } else {
            let mut axes = [None; 3];
            axes[axis] = Some(column);
            groups.push((m.label.clone(), m.grade, axes));
        }
    }
    let mut out: Vec<Triple> = Vec::new();
    for (label, grade, axes) in groups {
        let [Some(x), Some(y), Some(z)] = axes else { continue };
        let unit = reading.meanings.get(x).and_then(|m| m.unit);
        let twins = out.iter().filter(|t| t.label == label && t.grade == grade).count();
        let label = if twins > 0 { format!("{label} #{}", twins + 1).trim().to_owned() } else { label };
        out.push(Triple { columns: [x, y, z], unit, label, grade });
    }
    // Of one sensor the best grade stays.
    let all = out.clone();
    out.retain(|t| !all.iter().any(|o| o.label == t.label && o.grade < t.grade));
    out
}

/// One acceleration and one angular rate; asks where there are several.
fn choose_sensors(
    sheet: &Sheet<'_>,
    plan: &mut Plan,
    mut acc: Vec<Triple>,
    mut gyro: Vec<Triple>,
    options: &Options,
) -> Result<()> {
    let fail = |problem| Err(Error::of_file(sheet.name, problem));
    let names = |acc: &[Triple], gyro: &[Triple]| {
        let mut names: Vec<String> = Vec::new();
        for t in acc.iter().chain(gyro) {
            let name = if t.label.is_empty() { "main".to_owned() } else { t.label.clone() };
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    };
    if let Some(asked) = &options.sensor {
        let wanted = asked.trim().to_lowercase();
        let fits = |t: &Triple| t.label == wanted || (wanted == "main" && t.label.is_empty());
        let partly = |t: &Triple| {
            t.label.contains(&wanted)
                || t.label.replace(' ', "").contains(&wanted.replace([' ', '_', '-'], ""))
        };
        let all = names(&acc, &gyro);
        let mut hit = false;
        for list in [&mut acc, &mut gyro] {
            if list.iter().any(fits) {
                list.retain(fits);
                hit = true;
            } else if list.iter().any(partly) {
                list.retain(partly);
                hit = true;
            }
        }
        if !hit && !wanted.is_empty() {
            return fail(Problem::NoSuchSensor { asked: asked.clone(), names: all });
        }
    }
    if acc.len() > 1 || gyro.len() > 1 {
        let paired: Vec<String> =
            acc.iter().filter(|a| gyro.iter().any(|g| g.label == a.label)).map(|a| a.label.clone()).collect();
        match paired.as_slice() {
            [one] => {
                acc.retain(|t| t.label == *one);
                gyro.retain(|t| t.label == *one);
            }
            [] if acc.len() <= 1 => return fail(Problem::ManySensors { names: names(&[], &gyro) }),
            [] if gyro.len() <= 1 => return fail(Problem::ManySensors { names: names(&acc, &[]) }),
            _ => return fail(Problem::ManySensors { names: names(&acc, &gyro) }),
        }
    }
    plan.acc = acc.into_iter().next();
    plan.gyro = gyro.into_iter().next();
    Ok(())
}

fn given_axes(given: &[Option<usize>; 8], first: usize) -> Option<[usize; 3]> {
    Some([given.get(first).copied()??, given.get(first + 1).copied()??, given.get(first + 2).copied()??])
}

/// The columns the user named.
fn resolve(
    sheet: &Sheet<'_>,
    names: &[String],
    roles: &[Option<ColumnRef>; 8],
) -> Result<[Option<usize>; 8]> {
    let mut out = [None; 8];
    for (slot, role) in out.iter_mut().zip(roles) {
        *slot = match role {
            None => None,
            Some(ColumnRef::Number(n)) if *n >= 1 && *n <= names.len() => Some(n - 1),
            Some(ColumnRef::Number(n)) => {
                return Err(Error::of_file(
                    sheet.name,
                    Problem::NoSuchColumn { asked: n.to_string(), columns: names.to_vec() },
                ));
            }
            Some(ColumnRef::Name(name)) => Some(find(sheet, names, name)?),
        };
    }
    Ok(out)
}

fn find(sheet: &Sheet<'_>, names: &[String], asked: &str) -> Result<usize> {
    let same = |a: &str| a.trim().eq_ignore_ascii_case(asked.trim());
    names
        .iter()
        .position(|n| same(n))
        .or_else(|| sheet.header.iter().position(|n| same(n)))
        .or_else(|| {
            // A part of the name, where only one column has it.
            let lower = asked.to_lowercase();
            let mut hits =
                (0..names.len()).filter(|i| names.get(*i).is_some_and(|n| n.to_lowercase().contains(&lower)));
            let first = hits.next()?;
            hits.next().is_none().then_some(first)
        })
        .ok_or_else(|| {
            Error::of_file(
                sheet.name,
                Problem::NoSuchColumn { asked: asked.to_owned(), columns: names.to_vec() },
            )
        })
}

fn apply_given(plan: &mut Plan, reading: &Reading, given: &[Option<usize>; 8]) {
    if let Some(time) = given[0] {
        plan.time = Some(time);
    }
    if let Some(temp) = given[7] {
        plan.temp = Some(temp);
    }
    for (first, quantity, slot) in
        [(1, Quantity::Acceleration, &mut plan.acc), (4, Quantity::AngularRate, &mut plan.gyro)]
    {
        let mut columns: [Option<usize>; 3] = slot.as_ref().map_or([None; 3], |t| t.columns.map(Some));
        let mut any = false;
        for axis in 0..3 {
            if let Some(column) = given[first + axis] {
                columns[axis] = Some(column);
                any = true;
            }
        }
        if let (true, [Some(x), Some(y), Some(z)]) = (any, columns) {
            let unit = reading.meanings.get(x).and_then(|m| m.unit).filter(|u| {
                matches!(
                    (quantity, u),
                    (Quantity::Acceleration, Unit::Acceleration(..))
                        | (Quantity::AngularRate, Unit::AngularRate(..))
                        | (_, Unit::Counts)
                )
            });
            *slot = Some(Triple { columns: [x, y, z], unit, label: String::new(), grade: Grade::Plain });
        }
    }
}

/// Some axes of a quantity but not all: say which are missing.
fn check_partial(sheet: &Sheet<'_>, reading: &Reading, plan: &Plan, names: &[String]) -> Result<()> {
    let mut missing = Vec::new();
    for (quantity, prefix, found) in [
        (Quantity::Acceleration, "acc", plan.acc.is_some()),
        (Quantity::AngularRate, "gyr", plan.gyro.is_some()),
    ] {
        if found {
            continue;
        }
        let axes: Vec<u8> =
            reading.meanings.iter().filter(|m| m.quantity == quantity).filter_map(|m| m.axis).collect();
        if axes.is_empty() {
            continue;
        }
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            if !axes.contains(&(axis as u8)) {
                missing.push(format!("{prefix}_{letter}"));
            }
        }
    }
    if missing.is_empty() {
        return Ok(());
    }
    let problem = Problem::MissingColumn { missing, columns: names.to_vec() };
    let line = (sheet.data_line > 1 && !sheet.header.is_empty()).then(|| sheet.data_line - 1);
    Err(Error::at(problem, Place { file: sheet.name.to_owned(), line, column: None }))
}
