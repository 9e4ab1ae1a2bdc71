// Six equations in six unknowns.

/**
 * x of a·x = b, by Cholesky's method. `a`: 6 × 6, symmetric and positive definite, its lower triangle alone
 * is read; it is overwritten.
 */
export function solve_symmetric(a: Float64Array, b: readonly number[]): number[] {
  const n = 6, x = [...b];
  for (let row = 0; row < n; ++row) {
    for (let column = 0; column <= row; ++column) {
      let sum = a[n * row + column];
      for (let k = 0; k < column; ++k) sum -= a[n * row + k] * a[n * column + k];
      a[n * row + column] = column === row ? Math.sqrt(sum) : sum / a[n * column + column];
    }
    for (let k = 0; k < row; ++k) x[row] -= a[n * row + k] * x[k];
    x[row] /= a[n * row + row];
  }
  for (let row = n; row-- > 0;) {
    for (let k = row + 1; k < n; ++k) x[row] -= a[n * k + row] * x[k];
    x[row] /= a[n * row + row];
  }
  return x;
}
