// The filter that turns white noise into a road's velocity, as susp_ss.feedback.shaping.

// Steps of Aberth's iteration at most, and the relative step at which it ends.
const ABERTH = 200, STILL = 1e-14;

// W(s) = direct + sum gains / (s + rates) of a spectrum of real first-order terms.
function shapingOf(spectrum) {
  const kept = spectrum.terms.map(({ alpha, low, high }) => ({ rate: alpha.re, low: low.re, high: high.re }))
    .filter(({ low, high }) => low !== 0 || high !== 0).sort((one, other) => one.rate - other.rate);
  const { level } = spectrum, white = level + sum(spectrum.terms.map(({ high }) => high.re));
  if (!kept.length) return { direct: Math.sqrt(white), rates: [], gains: [], standing: Math.sqrt(white) };
  const size = Math.max(Math.abs(level), ...kept.flatMap(({ low, high }) => [Math.abs(low), Math.abs(high)]));
  const bounded = white <= SHAPING.white * size;
  const falling = sum(kept.map(({ rate, low, high }) => (low - high) * rate ** 2));
  const lead = Math.sqrt(Math.max(bounded ? falling : white, 0));
  const zeros = spectralZeros(level, kept, kept.length - bounded).map(root), direct = bounded ? 0 : lead;
  const rates = kept.map(({ rate }) => rate);
  const gains = rates.map((rate, k) => {
    const others = rates.filter((_, i) => i !== k), off = (zero) => minus(zero, complex(rate));
    const last = zeros.slice(zeros.length - others.length);
    const times = (total, other, i) => product(total, scaled(off(last[i]), 1 / (other - rate)));
    return lead * others.reduce(times, bounded ? complex(1) : off(zeros[0])).re;
  });
  for (const omega of SHAPING.felt) {
    const w2 = omega ** 2, at = ({ rate, low, high }) => (low * rate ** 2 + high * w2) / (rate ** 2 + w2);
    const fading = (total, rate, k) => plus(total, quotient(complex(gains[k]), complex(rate, omega)));
    const found = power(rates.reduce(fading, complex(direct))), asked = level + sum(kept.map(at));
    if (!(Math.abs(found / asked - 1) <= SHAPING.lost)) throw new Refusal(WORDS.unshaped);
  }
  const low = gains.map((gain, k) => gain / rates[k]), total = direct + sum(low);
  const terms = Math.abs(direct) + sum(low.map(Math.abs));
  return { direct, rates, gains, standing: Math.abs(total) > SHAPING.lost * terms ? total : 0 };
}

// Zeros over s^2 by Aberth's iteration, which starts between the poles.
function spectralZeros(level, terms, count) {
  const squares = terms.map(({ rate }) => rate ** 2), turn = complex(Math.cos(0.1), Math.sin(0.1));
  const between = squares.slice(1).map((one, k) => Math.sqrt(one * squares[k]));
  let z = [...between, squares.at(-1) * 1.5].slice(0, count).map((one) => scaled(turn, one));
  for (let round = 0; round < ABERTH; round++) {
    const steps = z.map((one, i) => {
      let value = complex(level), slope = complex(0), poles = complex(0), apart = complex(0);
      terms.forEach(({ low, high }, k) => {
        const gap = quotient(complex(1), minus(complex(squares[k]), one));
        value = plus(value, product(minus(complex(low * squares[k]), scaled(one, high)), gap));
        slope = plus(slope, scaled(product(gap, gap), (low - high) * squares[k]));
        poles = plus(poles, gap);
      });
      z.forEach((other, j) => j !== i && (apart = plus(apart, quotient(complex(1), minus(one, other)))));
      const newton = quotient(complex(1), minus(quotient(slope, value), poles));
      const step = quotient(newton, minus(complex(1), product(newton, apart)));
      return Number.isFinite(step.re + step.im) ? step : complex(0);
    });
    z = z.map((one, i) => minus(one, steps[i]));
    if (steps.every((step, i) => modulus(step) <= STILL * modulus(z[i]))) break;
  }
  return z.map((one) => (one.re < 0 && Math.abs(one.im) < 1e-6 * modulus(one) ? complex(0) : one));
}
