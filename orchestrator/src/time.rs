//! Exact time. Intervals are rational numbers; all of a system are whole multiples of one tick, and a point in time
//! is a count of ticks. So nothing drifts, and points that coincide are equal.
//!
//! What the units get is the double nearest to the exact time, `float(Fraction)` of Python: [`Rational::to_f64`] is
//! correctly rounded. The step size is the double nearest to the exact interval.

use std::fmt;

/// An exact number: numerator and positive denominator in lowest terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Rational {
    numerator: i64,
    denominator: i64,
}

impl Rational {
    /// 0.
    pub const ZERO: Self = Self { numerator: 0, denominator: 1 };

    /// numerator/denominator; `None` where the denominator is zero or the result doesn't fit 64 bits.
    pub fn new(numerator: i128, denominator: i128) -> Option<Self> {
        if denominator == 0 {
            return None;
        }
        let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()) as i128;
        let sign = denominator.signum();
        Some(Self {
            numerator: i64::try_from(sign * (numerator / common)).ok()?,
            denominator: i64::try_from(sign * (denominator / common)).ok()?,
        })
    }

    /// Reads `"1/30"`, `"0.001"`, `"5e-3"`, `"2"`, exactly. `None` where it is no such number or doesn't fit.
    pub fn parse(text: &str) -> Option<Self> {
        match text.split_once('/') {
            None => decimal(text.trim()),
            Some((over, under)) => {
                let (a, b) = (decimal(over.trim())?, decimal(under.trim())?);
                Self::new(
                    i128::from(a.numerator) * i128::from(b.denominator),
                    i128::from(a.denominator) * i128::from(b.numerator),
                )
            }
        }
    }

    /// The shortest decimal number that is this double: 0.1 gives 1/10.
    pub fn from_f64(value: f64) -> Option<Self> {
        if value.is_finite() { Self::parse(&format!("{value:e}")) } else { None }
    }

    /// Reads a decimal or a fraction. A decimal with so many digits that a program must have printed it is taken for the
    /// simple fraction that it came from, if there is one: 0.0016666666666666668 and 0.00166666666666667 give 1/600. Tells
    /// whether it was.
    pub fn recover(text: &str) -> Option<(Self, bool)> {
        let exact = Self::parse(text);
        match simplest(text) {
            // Better the fraction that rounds to the same double than none.
            Some((simple, printed)) if (printed || exact.is_none()) && exact != Some(simple) => {
                Some((simple, true))
            }
            _ => exact.map(|exact| (exact, false)),
        }
    }

    /// The double nearest to the exact value (ties to even).
    pub fn to_f64(self) -> f64 {
        quotient(self.numerator, self.denominator)
    }

    /// Above the line, in lowest terms.
    pub fn numerator(self) -> i64 {
        self.numerator
    }

    /// Below the line, in lowest terms; positive.
    pub fn denominator(self) -> i64 {
        self.denominator
    }

    /// Greater than zero.
    pub fn is_positive(self) -> bool {
        self.numerator > 0
    }

    /// Less than zero.
    pub fn is_negative(self) -> bool {
        self.numerator < 0
    }
}

impl PartialOrd for Rational {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Rational {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let (a, b) = (i128::from(self.numerator), i128::from(self.denominator));
        let (c, d) = (i128::from(other.numerator), i128::from(other.denominator));
        (a * d).cmp(&(c * b))
    }
}

/// `1/30`, or `5` where the denominator is 1: what [`Rational::parse`] reads back.
impl fmt::Display for Rational {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            _ => write!(f, "{}/{}", self.numerator, self.denominator),
        }
    }
}

fn decimal(text: &str) -> Option<Rational> {
    let (mantissa, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], text[at + 1..].parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let (sign, whole) = match whole.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, whole.strip_prefix('+').unwrap_or(whole)),
    };
    let digits = [whole, fraction].concat();
    if digits.is_empty() || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let number: i128 = digits.parse().ok()?;
    let shift = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
    let power = 10i128.checked_pow(shift.unsigned_abs())?;
    if shift < 0 {
        Rational::new(sign * number, power)
    } else {
        Rational::new(sign * number.checked_mul(power)?, 1)
    }
}

/// So many digits nobody types; a double that is no short decimal is printed with 13 to 17.
const PRINTED: usize = 13;

/// The fraction with the smallest denominator that is printed as this decimal or rounds to its double, and whether the
/// decimal stands for it: it has as many digits as programs print, and its denominator is so small that it is met by
/// chance once in a thousand at most (of d digits, within half of the last one lie q²/10ᵈ fractions up to q).
fn simplest(text: &str) -> Option<(Rational, bool)> {
    let text = text.trim();
    let value: f64 = text.parse().ok().filter(|value: &f64| value.is_finite() && *value != 0.0)?;
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let fraction = mantissa.split_once('.').map_or("", |(_, fraction)| fraction);
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let places = i32::try_from(fraction.len()).ok()?.checked_sub(exponent.parse().ok()?)?;
    let number: i128 = digits.parse().ok()?;
    let power = 10i128.checked_pow(u32::try_from(places).ok()?)?;
    let significant = digits.trim_start_matches('0').len();
    let chance = 10i128.checked_pow(u32::try_from(significant).ok()?.saturating_sub(3))?;
    let sign = if value < 0.0 { -1 } else { 1 };
    // Convergents of the continued fraction: p/q of each is nearer than any fraction with a smaller denominator.
    let (mut over, mut under) = (number, power);
    let (mut p, mut q) = ((0i128, 1i128), (1i128, 0i128));
    while under != 0 {
        let whole = over / under;
        (over, under) = (under, over % under);
        p = (p.1, whole.checked_mul(p.1)?.checked_add(p.0)?);
        q = (q.1, whole.checked_mul(q.1)?.checked_add(q.0)?);
        let found = Rational::new(sign * p.1, q.1)?;
        let off = p.1.checked_mul(power)?.checked_sub(number.checked_mul(q.1)?)?.checked_abs()?;
        if found.to_f64() == value || off.checked_mul(2)? <= q.1 {
            let printed =
                significant >= PRINTED && q.1.checked_mul(q.1).is_some_and(|square| square <= chance);
            return Some((found, printed));
        }
    }
    None
}

fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

/// Whole numbers up to this are exact as doubles.
const EXACT: u64 = 1 << 53;

/// Correctly rounded numerator/denominator; denominator > 0.
#[inline]
fn quotient(numerator: i64, denominator: i64) -> f64 {
    if numerator.unsigned_abs() <= EXACT && denominator.unsigned_abs() <= EXACT {
        // Both are exact, and IEEE division rounds correctly.
        return numerator as f64 / denominator as f64;
    }
    long_quotient(numerator, denominator)
}

/// The same where the numbers are too long for a double: division of integers with a sticky last bit.
#[cold]
fn long_quotient(numerator: i64, denominator: i64) -> f64 {
    let (over, under) = (u128::from(numerator.unsigned_abs()), u128::from(denominator.unsigned_abs()));
    if over == 0 {
        return 0.0;
    }
    // Shifted to 127 bits, the quotient has at least 63 bits: ten more than a double, so that with the sticky bit
    // the conversion below is the only rounding.
    let shift = over.leading_zeros() - 1;
    let shifted = over << shift;
    let sticky = u128::from(!shifted.is_multiple_of(under));
    let magnitude = ((shifted / under) | sticky) as f64 * 2f64.powi(-(shift as i32));
    if numerator < 0 { -magnitude } else { magnitude }
}

/// The tick of a system and its origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    tick: Rational,
    /// Numerators of times up to that of this tick are exact as doubles, and so is the denominator; 0 if it isn't.
    short: u64,
    denominator: f64,
}

impl Clock {
    /// The longest tick of which all given times are whole multiples; `None` where one wouldn't fit 64 bits.
    pub fn of(times: impl IntoIterator<Item = Rational>) -> Option<Self> {
        let mut tick = Rational::ZERO;
        for time in times {
            let (a, b) = (i128::from(tick.numerator), i128::from(tick.denominator));
            let (c, d) = (i128::from(time.numerator), i128::from(time.denominator));
            let over = gcd((a * d).unsigned_abs(), (c * b).unsigned_abs());
            tick = if a == 0 && c == 0 {
                Rational::ZERO
            } else {
                Rational::new(i128::try_from(over).ok()?, b * d)?
            };
        }
        if tick == Rational::ZERO {
            tick = Rational { numerator: 1, denominator: 1 };
        }
        let (over, under) = (tick.numerator.unsigned_abs(), tick.denominator.unsigned_abs());
        let short = if under <= EXACT { EXACT / over } else { 0 };
        Some(Self { tick, short, denominator: tick.denominator as f64 })
    }

    /// A time as ticks; `None` where it is no whole multiple or doesn't fit.
    pub fn ticks(&self, time: Rational) -> Option<i64> {
        let over = i128::from(time.numerator) * i128::from(self.tick.denominator);
        let under = i128::from(time.denominator) * i128::from(self.tick.numerator);
        if over % under == 0 { i64::try_from(over / under).ok() } else { None }
    }

    /// The double nearest to the time of a tick. Ticks up to the one checked by [`Clock::holds`] don't overflow.
    #[inline]
    pub fn seconds(&self, ticks: i64) -> f64 {
        if ticks.unsigned_abs() <= self.short {
            // Both are exact, and IEEE division rounds correctly.
            return (ticks * self.tick.numerator) as f64 / self.denominator;
        }
        quotient(ticks * self.tick.numerator, self.tick.denominator)
    }

    /// Whether the times up to a tick can be computed. Half of the range is left for the sums of a time and a delay or interval.
    pub fn holds(&self, ticks: i64) -> bool {
        ticks.unsigned_abs() < 1 << 62 && ticks.checked_mul(self.tick.numerator).is_some()
    }

    /// Length of a tick.
    pub fn tick(&self) -> Rational {
        self.tick
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rational(text: &str) -> Rational {
        Rational::parse(text).expect(text)
    }

    #[test]
    fn value_numbers_are_read_exactly() {
        for (text, exact) in [
            ("1/30", "1/30"),
            ("0.001", "1/1000"),
            ("5e-3", "1/200"),
            ("2.50", "5/2"),
            ("-1.5E1", "-15"),
            ("30", "30"),
            ("1/0.5", "2"),
        ] {
            assert_eq!(rational(text).to_string(), exact, "{text}");
        }
        for wrong in [
            "",
            "x",
            "1/0",
            "1/",
            "1..2",
            "e3",
            "1e400",
            "1e-40",
            "1/2/3",
            "99999999999999999999",
            "--5",
            "+-5",
        ] {
            assert_eq!(Rational::parse(wrong), None, "{wrong}");
        }
        for (text, negative, positive) in [("-1/3", true, false), ("0", false, false), ("1e-9", false, true)]
        {
            assert_eq!(
                (rational(text).is_negative(), rational(text).is_positive()),
                (negative, positive),
                "{text}"
            );
        }
        assert_eq!(Rational::from_f64(0.1), Some(rational("1/10")));
        assert_eq!(Rational::from_f64(f64::NAN), None);
    }

    #[test]
    fn value_decimals_that_a_float_printed_are_the_fractions_they_came_from() {
        for (text, fraction) in [
            ("0.0003333333333333333", "1/3000"),
            ("0.0016666666666666668", "1/600"),
            ("1.6666666666666668e-3", "1/600"),
            ("0.00166666666666667", "1/600"),
            ("0.03333333333333333", "1/30"),
            ("0.14285714285714285", "1/7"),
            ("-2.3333333333333335", "-7/3"),
        ] {
            assert_eq!(Rational::recover(text), Some((rational(fraction), true)), "{text}");
        }
        for exact in ["0.001", "0.333333", "0.1234567890123", "1/30", "12", "0", "0.5000000000000001"] {
            assert_eq!(Rational::recover(exact), Some((rational(exact), false)), "{exact}");
        }
        // Python's Fraction.limit_denominator finds the same; no exact decimal of it fits.
        let (near, noted) = Rational::recover("3.141592653589793e-3").expect("some fraction rounds to it");
        assert!(noted || near == rational("3.141592653589793e-3"));
        assert_eq!(near.to_f64(), 3.141592653589793e-3);
        for wrong in ["", "x", "nan", "inf", "1e400"] {
            assert_eq!(Rational::recover(wrong), None, "{wrong}");
        }
        // Every n-th that a float can print comes back.
        for under in 1..2000 {
            let text = format!("{:?}", 1.0 / f64::from(under));
            let (found, _) = Rational::recover(&text).expect("read");
            assert_eq!(found, Rational::new(1, i128::from(under)).expect("fits"), "{text}");
        }
    }

    #[test]
    fn value_doubles_are_pythons() {
        // float(Fraction(n, d)) of CPython 3.11.
        assert_eq!(rational("1/600").to_f64().to_bits(), 0x3f5b_4e81_b4e8_1b4f);
        assert_eq!(rational("9223372036854775807/3").to_f64(), 3.0744573456182584e18);
        assert_eq!(rational("1/9223372036854775807").to_f64(), 1.0842021724855044e-19);
        assert_eq!(rational("9007199254740993/9007199254740995").to_f64(), 0.9999999999999998);
        // One of the two is no double: n/d of CPython 3.11, which a division of doubles misses.
        assert_eq!(rational("411/295532457850265058").to_f64(), 1.3907101879423272e-15);
        assert_eq!(rational("43/451769784114599452").to_f64(), 9.518122174610129e-17);
        let fine = Clock::of([rational("1/451769784114599452")]).expect("fits");
        assert_eq!(fine.seconds(43), 9.518122174610129e-17);
        assert_eq!(
            rational("9007199254740993").to_f64(),
            9007199254740992.0,
            "just between two, to the even one"
        );
        let clock = Clock::of([rational("3/7")]).expect("fits");
        for (ticks, seconds) in
            [(933_450_066_154_674_430, 4.000500283520033e17), (7755714868685789, 3323877800865338.0)]
        {
            assert_eq!(clock.seconds(ticks), seconds);
        }
        assert!(clock.holds(i64::MAX / 3) && !clock.holds(i64::MAX / 3 + 1));
    }

    #[test]
    fn law_long_division_agrees_with_the_short_one() {
        let mut state = 1u64;
        for _ in 0..20_000 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let (a, b) = ((state >> 33) as i64 - (1 << 30), (state >> 40) as i64 + 1);
            assert_eq!(quotient(a, b).to_bits(), if a == 0 { 0 } else { long_quotient(a, b).to_bits() });
        }
    }

    #[test]
    fn law_ticks_are_common() {
        let times = ["0.001", "0.005", "1/30", "30"].map(rational);
        let clock = Clock::of(times).expect("fits");
        assert_eq!(clock.tick(), rational("1/3000"));
        assert_eq!(times.map(|time| clock.ticks(time)), [Some(3), Some(15), Some(100), Some(90_000)]);
        assert_eq!(clock.ticks(rational("1/7")), None);
        assert_eq!(clock.seconds(300), 0.1);
        assert_eq!(Clock::of(["1/9223372036854775807", "1/9223372036854775806"].map(rational)), None);
    }
}
