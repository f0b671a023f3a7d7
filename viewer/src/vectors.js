// Arithmetic of vectors that are arrays.

export const dot = (u, v) => u.reduce((sum, value, a) => sum + value * v[a], 0);

export const difference = (u, v) => u.map((value, a) => value - v[a]);
