// How alike two pictures are, and what is in one.

/** Mean structural similarity of the luma over windows of 8 × 8 pixels, every 4, as runtime/draw/picture_compare.h.
 *  @param a,b  RGBA of the same size. */
export function ssim(a, b, width, height) {
  const [x, y] = [luma(a), luma(b)];
  const c1 = (0.01 * 255) ** 2;
  const c2 = (0.03 * 255) ** 2;
  let sum = 0;
  let windows = 0;
  for (let top = 0; top + 8 <= height; top += 4)
    for (let left = 0; left + 8 <= width; left += 4) {
      let [sx, sy, sxx, syy, sxy] = [0, 0, 0, 0, 0];
      for (let j = top; j < top + 8; ++j)
        for (let i = left; i < left + 8; ++i) {
          const [p, q] = [x[j * width + i], y[j * width + i]];
          sx += p;
          sy += q;
          sxx += p * p;
          syy += q * q;
          sxy += p * q;
        }
      const [mx, my] = [sx / 64, sy / 64];
      const [vx, vy, cov] = [sxx / 64 - mx * mx, syy / 64 - my * my, sxy / 64 - mx * my];
      sum += ((2 * mx * my + c1) * (2 * cov + c2)) / ((mx * mx + my * my + c1) * (vx + vy + c2));
      ++windows;
    }
  return sum / windows;
}

function luma(rgba) {
  return Float64Array.from({ length: rgba.length / 4 }, (_, i) => {
    return 0.299 * rgba[4 * i] + 0.587 * rgba[4 * i + 1] + 0.114 * rgba[4 * i + 2];
  });
}

/** Share of the pixels that are not white. */
export function inked(rgba) {
  let count = 0;
  for (let i = 0; i < rgba.length; i += 4) if (rgba[i] + rgba[i + 1] + rgba[i + 2] < 3 * 250) ++count;
  return count / (rgba.length / 4);
}
