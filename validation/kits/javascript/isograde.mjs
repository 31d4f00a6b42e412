// Lets isograde grade a program in JavaScript or TypeScript, under Node.js.
//
//     import { serve } from "./isograde.mjs";
//     serve({ name: "mine" }, (values, shape, isovalue, spacing) => ({ vertices, triangles }));
//
// `serve` reads requests from standard input until there are no more, calls the function for each,
// and answers. The samples are a typed array in C order, the last axis fastest; float16 comes as a
// Float32Array, bool as a Uint8Array, 64-bit integers as bigints. What is wrong is thrown.
// Answers go to descriptor 3, so that whoever prints does no harm: `run` sees to it.
import { createWriteStream, readFileSync } from "node:fs";
import { createInterface } from "node:readline";

/**
 * @typedef {Int8Array | Int16Array | Int32Array | BigInt64Array | Uint8Array | Uint16Array
 *   | Uint32Array | BigUint64Array | Float32Array | Float64Array} Values
 * @typedef {[number, number, number]} Three
 * @typedef {object} Mesh
 * @property {Three[]} vertices index * spacing
 * @property {Three[]} triangles three vertices each, from 0, counterclockwise seen from low values
 * @typedef {(values: Values, shape: Three, isovalue: number, spacing: Three) => Mesh} Extract
 * @typedef {object} Request a line of the protocol; an isovalue that is not finite is a text
 * @property {number} id
 * @property {string} dtype
 * @property {Three} shape
 * @property {Three} spacing
 * @property {(number | string)[]} isovalues
 * @property {number} offset
 * @property {string} values the path of the samples' file
 */

/** @type {Record<string, { new (buffer: ArrayBuffer): Values, BYTES_PER_ELEMENT: number }>} */
const TYPES = {
  b1: Uint8Array, u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, u8: BigUint64Array,
  i1: Int8Array, i2: Int16Array, i4: Int32Array, i8: BigInt64Array,
  f2: Uint16Array, f4: Float32Array, f8: Float64Array,
};

/**
 * The sample as a number. A bigint that no number holds is rounded down, so that the number is at
 * least the isovalue exactly where the sample is.
 * @param {number | bigint} value
 */
export function number(value) {
  let wide = Number(value);
  if (typeof value === "number") return wide;
  // Steps that are too small for the number change nothing; the first that is not ends the loop.
  for (let step = 1; BigInt(wide) > value; step *= 2) wide -= step;
  return wide;
}

/**
 * The number with these 16 bits.
 * @param {number} half
 */
function widened(half) {
  const sign = half >> 15 ? -1 : 1;
  const power = (half >> 10) & 31;
  const part = half & 1023;
  if (power === 0) return sign * part * 2 ** -24;
  if (power === 31) return part ? NaN : sign * Infinity;
  return sign * (part + 1024) * 2 ** (power - 25);
}

/**
 * The samples of a request, read from their file.
 * @param {Request} asked
 * @returns {Values}
 */
function samples({ dtype, offset, shape, values: path }) {
  const kind = dtype.slice(1);
  const Type = TYPES[kind];
  if (!Type) throw new Error(`samples of an unknown type: ${dtype}`);
  const size = Type.BYTES_PER_ELEMENT;
  const count = shape[0] * shape[1] * shape[2];
  const bytes = new Uint8Array(readFileSync(path).subarray(offset, offset + count * size));
  if (bytes.length < count * size) throw new Error("the file of samples is too short");
  if (dtype[0] === ">")
    for (let at = 0; at < bytes.length; at += size) bytes.subarray(at, at + size).reverse();
  const values = new Type(bytes.buffer);
  const halves = kind === "f2" && values instanceof Uint16Array;
  return halves ? Float32Array.from(values, widened) : values;
}

/**
 * The answer to a request for a mesh.
 * @param {Request} asked
 * @param {Extract} extract
 */
function answer(asked, extract) {
  const { id, shape, isovalues, spacing } = asked;
  try {
    if (shape.length !== 3 || isovalues.length !== 1)
      throw new Error("it takes one field with three axes");
    const isovalue = Number(isovalues[0]); // "Infinity" and "NaN" are texts.
    const { vertices, triangles } = extract(samples(asked), shape, isovalue, spacing);
    return { id, vertices, simplices: triangles };
  } catch (error) {
    return { id, error: String(error) };
  }
}

/**
 * Answers every request with a line.
 * @param {object} declaration what the extractor says of itself: `isograde explain declaration`
 * @param {Extract} extract
 */
export async function serve(declaration, extract) {
  const answers = createWriteStream("", { fd: 3 });
  for await (const line of createInterface({ input: process.stdin })) {
    const asked = JSON.parse(line);
    if (asked.command === "stop") break;
    const said =
      asked.command === "start" ? { protocol: 3, declaration } : answer(asked, extract);
    answers.write(JSON.stringify(said) + "\n");
  }
}
