//! Dates and times of day as a clock: a column of them is read as seconds since the log's first row.

use crate::observe::is_date;
use chrono::format::{Item, Parsed, StrftimeItems, parse};
use chrono::{NaiveDate, NaiveDateTime, NaiveTime, TimeDelta};

/// How dates are written: by ISO 8601, in Germany, in the United States, in the United Kingdom; and not at all.
const DATES: [&str; 6] = ["%Y-%m-%d ", "%Y/%m/%d ", "%d.%m.%Y ", "%m/%d/%Y ", "%d/%m/%Y ", ""];
/// How times of day are written, and not at all.
const TIMES: [&str; 5] = ["%H:%M:%S%.f", "%I:%M:%S%.f %p", "%H:%M", "%I:%M %p", ""];
/// With the distance from Greenwich, and without.
const ZONES: [&str; 2] = ["", " %#z"];

/// What can be written, for those who wrote something else.
pub(super) const READ: &str = "dates and times are read as 2026-03-28T23:59:55.5Z, 28.03.2026 23:59:55, 03/28/2026 11:59:55 PM or 23:59:55.5";

/// A column of dates, times of day, or both.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Timestamps {
    /// At Greenwich where there is a zone. Nothing where the cell is empty.
    at: Vec<Option<NaiveDateTime>>,
    /// Dates stand in it.
    pub(super) dated: bool,
    /// Times of day stand in it.
    pub(super) timed: bool,
}

/// Seconds since the first row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Seconds {
    /// `NaN` where there is no time.
    pub(super) values: Vec<f64>,
    /// Rows before which midnight passed unseen.
    pub(super) midnights: Vec<usize>,
}

/// How all cells of a column are written.
struct Shape {
    items: Vec<Item<'static>>,
    text: String,
}

impl Shape {
    fn all() -> impl Iterator<Item = Self> {
        let texts = DATES.into_iter().flat_map(|date| {
            TIMES.into_iter().flat_map(move |time| {
                let zones = ZONES.into_iter().take(if time.is_empty() { 1 } else { ZONES.len() });
                zones.map(move |zone| format!("{date}{time}{zone}"))
            })
        });
        texts.filter(|text| !text.is_empty()).map(|text| {
            let items = StrftimeItems::new(&text).map(Item::to_owned).collect();
            Self { items, text }
        })
    }

    fn read(&self, cell: &str) -> Option<NaiveDateTime> {
        let mut parsed = Parsed::new();
        parse(&mut parsed, cell, self.items.iter()).ok()?;
        let date = if self.dated() { parsed.to_naive_date().ok()? } else { NaiveDate::default() };
        let time = if self.timed() { parsed.to_naive_time().ok()? } else { NaiveTime::default() };
        let zone = TimeDelta::seconds(i64::from(parsed.offset().unwrap_or(0)));
        date.and_time(time).checked_sub_signed(zone)
    }

    fn column(&self, cells: &[String]) -> Option<Vec<Option<NaiveDateTime>>> {
        let read = |cell: &String| if cell.is_empty() { Some(None) } else { self.read(cell).map(Some) };
        cells.iter().map(read).collect()
    }

    fn dated(&self) -> bool {
        self.text.contains("%Y")
    }

    fn timed(&self) -> bool {
        self.text.contains("%M")
    }
}

impl Timestamps {
    /// The cells of a column, empty ones where there is nothing, if each holds a date or a time and all are written alike.
    ///
    /// # Errors
    /// Day and month can be told either way, and it matters.
    pub(super) fn read(cells: &[impl AsRef<str>]) -> Result<Option<Self>, String> {
        let Some(first) =
            cells.iter().map(AsRef::as_ref).find(|cell| !cell.is_empty()).filter(|cell| is_date(cell))
        else {
            return Ok(None);
        };
        let cells: Vec<String> = cells.iter().map(|cell| plain(cell.as_ref())).collect();
        let mut fitting =
            Shape::all().filter_map(|shape| Some((shape.column(&cells)?, shape.dated(), shape.timed())));
        let Some((at, dated, timed)) = fitting.next() else { return Ok(None) };
        let found = Self { at, dated, timed };
        let bits = |one: &Self| one.seconds().values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        for (at, dated, timed) in fitting {
            if bits(&Self { at, dated, timed }) != bits(&found) {
                return Err(format!(
                    "{first:?} and those below are days of one month or of another: write 2026-03-28"
                ));
            }
        }
        Ok(Some(found))
    }

    /// Times of day with their dates, of two columns.
    pub(super) fn on(mut self, days: &Self) -> Self {
        for (at, day) in self.at.iter_mut().zip(&days.at) {
            *at = at.zip(*day).map(|(at, day)| day.date().and_time(at.time()));
        }
        self.dated = true;
        self
    }

    /// Seconds since the first row. Where no date stands beside it a time of day that goes back by more than half a day is the next day's.
    pub(super) fn seconds(&self) -> Seconds {
        let first = self.at.iter().flatten().next().copied();
        let (mut before, mut days, mut midnights) = (first, TimeDelta::zero(), Vec::new());
        let mut values = Vec::with_capacity(self.at.len());
        for (row, at) in self.at.iter().enumerate() {
            let (Some(at), Some(from), Some(last)) = (*at, first, before) else {
                values.push(f64::NAN);
                continue;
            };
            if !self.dated && last - at > TimeDelta::days(1) / 2 {
                days += TimeDelta::days(1);
                midnights.push(row);
            }
            before = Some(at);
            values.push((at - from + days).as_seconds_f64());
        }
        Seconds { values, midnights }
    }
}

/// A cell with a blank between date and time and a point before decimals.
fn plain(cell: &str) -> String {
    cell.trim().replace('T', " ").replace(',', ".")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(cells: &[&str]) -> Result<Option<Vec<f64>>, String> {
        Ok(Timestamps::read(cells)?.map(|timestamps| timestamps.seconds().values))
    }

    #[test]
    fn value_dates_and_times_are_a_clock() {
        for cells in [
            ["2026-03-28T23:59:55", "2026-03-28T23:59:55.010000", "2026-03-29T00:00:00.5"],
            ["2026-03-28 23:59:55Z", "2026-03-28 23:59:55.01Z", "2026-03-29 00:00:00.5Z"],
            // Greenwich and Berlin
            ["2026-03-28T22:59:55+00:00", "2026-03-28T23:59:55.010+01:00", "2026-03-29T00:00:00.500+0100"],
            ["28.03.2026 23:59:55,000", "28.03.2026 23:59:55,010", "29.03.2026 00:00:00,500"],
            ["03/28/2026 11:59:55.000 PM", "03/28/2026 11:59:55.010 PM", "03/29/2026 12:00:00.500 AM"],
            ["28/03/2026 23:59:55", "28/03/2026 23:59:55.01", "29/03/2026 00:00:00.5"],
            ["2026/03/28 23:59:55", "2026/03/28 23:59:55.01", "2026/03/29 00:00:00.5"],
            ["23:59:55", "23:59:55.010", "00:00:00.500"],
        ] {
            assert_eq!(seconds(&cells), Ok(Some(vec![0.0, 0.01, 5.5])), "{cells:?}");
        }
        assert_eq!(seconds(&["10:00", "10:01"]), Ok(Some(vec![0.0, 60.0])));
        for cells in [["0.5", "0.6"], ["on", "off"], ["10:00:00", "ten"], ["1.2", "10:00:00"]] {
            assert_eq!(seconds(&cells), Ok(None), "{cells:?}");
        }
        let missing = seconds(&["10:00:00", "", "10:00:02"]).expect("plain").expect("times");
        assert!(missing[1].is_nan() && missing[2] == 2.0, "{missing:?}");
    }

    #[test]
    fn value_midnight_is_seen_where_no_date_is_written() {
        let timestamps = Timestamps::read(&["23:59:59", "00:00:01", "00:00:00.5", "23:00:00", "01:00:00"]);
        let found = timestamps.expect("plain").expect("times").seconds();
        // half a second back is a row out of order
        assert_eq!(found.values, [0.0, 2.0, 1.5, 82_801.0, 90_001.0]);
        assert_eq!(found.midnights, [1, 4]);
    }

    #[test]
    fn value_dates_in_a_column_of_their_own() {
        let column = |cells: &[&str]| Timestamps::read(cells).expect("plain").expect("timestamps");
        let days = column(&["03/28/2026", "03/31/2026"]);
        assert!(days.dated && !days.timed);
        assert_eq!(column(&["11:59:58 PM", "12:00:01 AM"]).on(&days).seconds().values, [0.0, 172_803.0]);
    }

    #[test]
    fn error_of_days_that_may_be_months() {
        assert!(seconds(&["03/04/2026 10:00:00", "04/04/2026 10:00:00"]).unwrap_err().contains("2026-03-28"));
        assert_eq!(seconds(&["03/04/2026 10:00:00", "03/04/2026 10:00:01"]), Ok(Some(vec![0.0, 1.0])));
    }
}
