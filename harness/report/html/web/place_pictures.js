// The pictures of one scene and light, and of the rows there that are compared.

import { blob, colors, errors, shares } from "./blobs.js";
import { data, groupName } from "./data.js";

/** The choices of a group: all its lights, and of several each. */
export function placesOf(group) {
  const lights = data.groups[group].pictures.lights ?? [];
  return [
    { value: String(group), text: groupName(group) },
    ...lights.map((light, k) => ({ value: `${group}:${k}`, text: `${groupName(group)}: ${light.name} alone` })),
  ];
}

/** The rows of a group that have pictures. */
export const rowsOf = (group) => data.rows.filter((row) => row.group === group && row.pictures);

const given = (number, read) => (number === null ? null : read(number));

/**
 * Reads a frame as compose.js takes it, and a side for each of the rows; null is the reference. The first two are compared with
 * each other, the others with the first. `light` is one of several that is shown alone, null for all together.
 */
export async function readPlace(group, light, rows) {
  const { width, height, answer, scene, view, pictures: ofAll } = data.groups[group];
  const of = (pictures) => (light === null ? pictures : pictures.lights[light]);
  const pictures = of(ofAll);
  const truth = async (name, number, error) =>
    number === null ? null : { name, mask: await shares(number, pictures.bits), error: await given(error, errors) };
  const [lit, dark, bright, classes, area, irradiance] = await Promise.all([
    colors(pictures.lit),
    colors(pictures.dark),
    given(pictures.bright, colors),
    blob(pictures.classes),
    truth("reference", pictures.reference, pictures.reference_error),
    truth("reference, share of irradiance", pictures.irradiance, pictures.irradiance_error),
  ]);
  // Pictures of all light are those of all lights of a row.
  const globalOf = async (number) => (number === undefined || light !== null ? null : colors(number));
  const globalReference = rowsOf(group).find((row) => row.pictures.global !== undefined)?.pictures.global_reference;
  const side = async (row, other) => {
    const judge = ((row ?? other)?.estimates === "irradiance" && irradiance) || area;
    const compared = { row, truth: judge, reference: judge.mask, title: row?.title ?? judge.name };
    if (!row) return { ...compared, mask: judge.mask, causes: null, global: await globalOf(globalReference) };
    const own = of(row.pictures);
    const reads = [shares(own.mask, pictures.bits), given(own.causes, blob), globalOf(row.pictures.global)];
    const [mask, causes, global] = await Promise.all(reads);
    return { ...compared, mask, causes, global };
  };
  const sides = await Promise.all(rows.map((row, k) => side(row, rows[k === 0 ? 1 : 0])));
  const is_soft = pictures.is_fraction ?? answer !== "binary";
  const place = [scene, view, width, height].join();
  const frame = { width, height, is_soft, is_one_of_several: light !== null, lit, dark, bright, white: pictures.white, classes, place };
  return { frame, sides };
}
