import assert from "node:assert/strict";
import {test} from "node:test";

import * as decode from "../src/decode.js";
import {guessedRoles, placesOf, roleFlags, usualRoles} from "../src/studio/columns.js";
import {commandLine, outputsOf, seedsFile, unused} from "../src/studio/commands.js";
import {landscape} from "../src/studio/landscape.js";
import {sliderScale} from "../src/studio/options.js";
import {previewArgs} from "../src/studio/preview.js";
import {pythonLines} from "../src/studio/python_lines.js";
import {contourExtension, contourFiles, framesOf, isSeries, labelFiles, seriesOf} from "../src/studio/series.js";

test("sliders keep their values", () => {
  for (const range of [{lo: 1e-6, hi: 100, log: true}, {lo: 16, hi: 512, log: true, whole: true}, {lo: 0, hi: 20, step: 0.5}]) {
    const scale = sliderScale(range);
    assert.equal(scale.toValue(0), range.lo);
    assert.equal(scale.toValue(1000), range.hi);
    for (const place of [200, 500, 900]) assert.ok(Math.abs(scale.toPlace(scale.toValue(place)) - place) < 25);
  }
});

test("command lines are quoted as a shell needs it", () => {
  assert.equal(commandLine("fit", ["a b.csv", "-o", "f.csrbf", "--values", "it's"]), "csrbf fit 'a b.csv' -o f.csrbf --values 'it'\\''s'");
});

test("names that are taken get a number", () => {
  assert.equal(unused("a.nii.gz", new Set(["a.nii.gz", "a-2.nii.gz"])), "a-3.nii.gz");
  assert.equal(unused("a.ply", new Set()), "a.ply");
  assert.deepEqual(outputsOf("segment", {name: "head.nii.gz", kind: "volume"}, (name) => name),
    [["-o", "head-labels.nii.gz"], ["--contour", "head-contour.ply"], ["--report", "head-segment.html"]]);
  assert.deepEqual(outputsOf("reconstruct", {name: "scan.ply", kind: "points"}, (name) => name),
    [["-o", "scan-surface.ply"], ["--model", "scan.csrbf"], ["--report", "scan-reconstruct.html"]]);
});

test("columns have roles, and flags only where these are not the usual ones", () => {
  const column = (name, values = [1, 2]) => ({name, values});
  const columns = [column("x"), column("y"), column("depth"), column("note", [NaN, NaN])];
  assert.deepEqual(usualRoles(columns), ["coordinate", "coordinate", "value", ""]);
  assert.deepEqual(roleFlags(columns.slice(0, 3), ["coordinate", "coordinate", "value"]), []);
  assert.deepEqual(roleFlags(columns, ["coordinate", "value", "weight", ""]), [["--coordinates", "x"], ["--values", "y"], ["--weights", "depth"]]);
});

// Headers as tables of many fields have them; a star marks text. Then the coordinates, and the columns that may be the value.
const HEADERS = [
  ["x,y,v", "x y", "v"],
  ["x,y,z", "x y", "z"],
  ["x,y,z,v", "x y z", "v"],
  ["X,Y,Z,intensity", "X Y Z", "intensity"],
  ["id,x,y,value", "x y", "value"],
  ["Id,X,Y,V,U", "X Y", "V U"],
  ["x,y,cadmium,copper,lead,zinc,elev,dist", "x y", "cadmium copper lead zinc dist"],
  ["Xloc,Yloc,Landuse,Rock,Cd,Co,Cr", "Xloc Yloc", "Cd Co Cr"],
  ["lat,lon,depth", "lon lat", "depth"],
  ["time*,latitude,longitude,depth,mag,magType*", "longitude latitude depth", "mag"],
  ["station*,longitude,latitude,temperature,error", "longitude latitude", "temperature"],
  ["site,easting,northing,gravity,sigma", "easting northing", "gravity"],
  ["FID,E,N,au_ppm", "E N", "au_ppm"],
  ["OBJECTID,POINT_X,POINT_Y,grade", "POINT_X POINT_Y", "grade"],
  ["Lon [deg],Lat [deg],SSH (m),SSH_std (m)", "Lon [deg],Lat [deg]", "SSH (m)"],
  ["LON,LAT,TIME,SST,SST_err", "LON LAT TIME", "SST"],
  ["well_id,x_coord,y_coord,depth,porosity", "x_coord y_coord depth", "porosity"],
  ["utm_e,utm_n,head,head_error", "utm_e utm_n", "head"],
  ["north,east,rain", "east north", "rain"],
  ["name*,Latitude (WGS84),Longitude (WGS84),pm10", "Longitude (WGS84),Latitude (WGS84)", "pm10"],
  ["Unnamed: 0,x,y,value", "x y", "value"],
  ["Easting_m,Northing_m,Bouguer_mGal,sd", "Easting_m Northing_m", "Bouguer_mGal"],
  ["n,x,y,value", "x y", "value"],
  ["x,y,n,e,value", "x y", "value e"],
  // Without names of places, or where nothing else is left, the usual roles stay.
  ["a,b,c", "a b", "c"],
  ["angle,mach,lift", "angle mach", "lift"],
  ["r,theta,u", "r theta", "u"],
  ["t,signal", "t", "signal"],
  ["x,sigma", "x", "sigma"],
  ["x,y", "x", "y"],
  ["x,y,error", "x y", "error"],
  ["x1,x2,x3,y", "x1 x2 x3", "y"],
  ["1,2,3,4", "1 2 3", "4"],
];

test("names of columns suggest their roles", () => {
  for (const [header, coordinates, values] of HEADERS) {
    const columns = header.split(",").map((name) => ({name: name.replace("*", ""), values: name.endsWith("*") ? [NaN] : [1]}));
    const roles = guessedRoles(columns);
    const names = (role) => placesOf(columns, roles, role).map((i) => columns[i].name);
    assert.deepEqual(names("coordinate"), coordinates.split(coordinates.includes(",") ? "," : " "), header);
    const [value, ...others] = names("value");
    assert.ok(others.length === 0 && (values === value || values.split(" ").includes(value)), `${header}: ${value}`);
  }
  const turned = ["lat", "lon", "v"].map((name) => ({name, values: [1]}));
  assert.deepEqual(roleFlags(turned, guessedRoles(turned)), [["--coordinates", "lon,lat"], ["--values", "v"]]);
});

test("columns of one name go by number", () => {
  const columns = ["y", "x", "v", "v"].map((name) => ({name, values: [1]}));
  assert.deepEqual(roleFlags(columns, guessedRoles(columns)), [["--coordinates", "x,y"], ["--values", "4"]]);
});

test("what is painted has a file for each image, and none of the user's own", () => {
  const images = ["frame.001.pgm", "frame.002.pgm", "a.png", "a.tif", "head.T1.nii.gz"].map((name) => ({name, kind: "image"}));
  const file = (name, others = [], command = "segment") => seedsFile(images.find((image) => image.name === name), [...images, ...others], command);
  assert.equal(file("frame.001.pgm"), "frame.001-seeds.csv");
  assert.equal(file("a.tif"), "a.tif-seeds.csv");
  assert.equal(file("head.T1.nii.gz", [], "inpaint"), "head.T1-holes.nrrd");
  assert.equal(file("a.png", [{name: "a.png-seeds.csv", kind: "table", made: false}]), "a-2.png-seeds.csv");
  assert.equal(file("a.png", [{name: "a.png-seeds.csv", kind: "table", made: true}]), "a.png-seeds.csv");
});

test("previews write the first output only, with few cells", () => {
  const request = {command: "reconstruct", inputs: ["a.ply"], flags: [["--smoothing", "0.1"], ["--resolution", "400"]], outputs: [["-o", "m.ply"], ["--model", "m.csrbf"], ["--report", "r.html"]]};
  assert.deepEqual(previewArgs(request), ["a.ply", "-o", "m.ply", "--smoothing", "0.1", "--resolution", "64"]);
  assert.deepEqual(previewArgs({...request, command: "segment", inputs: ["a.png"], flags: [["--objects", true]], outputs: [["-o", "a-labels.png"]]}),
    ["a.png", "-o", "a-labels.mha", "--objects"]);
  // Patches of a given smoothing would take seconds.
  const inpaint = {command: "inpaint", inputs: ["a.png"], flags: [["--smoothing", "0.1"]], outputs: [["-o", "b.png"]]};
  assert.deepEqual(previewArgs(inpaint).slice(3), ["--smoothing", "0.1", "--method", "multilevel", "--kernel", "wendland-c2"]);
  assert.deepEqual(previewArgs({...inpaint, flags: [["--smoothing", "0.1"], ["--kernel", "cubic"]]}).slice(3), ["--smoothing", "0.1", "--kernel", "cubic"]);
});

test("the same in Python", () => {
  const lines = pythonLines({command: "reconstruct", inputs: ["scan.ply"], flags: [["--smoothing", "0.01"], ["--resolution", "64"], ["--method", "composite"]], outputs: [["-o", "m.ply"], ["--model", "m.csrbf"]]});
  assert.deepEqual(lines, ["import csrbf", "", 'cloud = csrbf.read_points("scan.ply")',
    'surface = csrbf.reconstruct(cloud, cloud.normals, smoothing=0.01, method="composite")', 'surface.polygonize(resolution=64).save("m.ply")', 'surface.save("m.csrbf")']);
  const columns = {coordinates: [0, 1], values: [2], weights: [3], names: ["x", "y", "v", "w"], named: true, separator: " ", firstLine: 2};
  const fit = (more, input = "s.txt") => pythonLines({command: "fit", inputs: [input], flags: [["--coordinates", "x,y"], ["--loss", "student"]],
    outputs: [["-o", "f.csrbf"]], columns: {...columns, ...more}});
  const reading = (...given) => fit(...given).find((line) => line.startsWith("table ="));
  assert.equal(reading(), String.raw`table = pd.read_csv("s.txt", sep=r"\s+", float_precision="round_trip")`);
  assert.equal(reading({separator: ","}), 'table = pd.read_csv("s.txt", skipinitialspace=True, float_precision="round_trip")');
  assert.equal(reading({separator: ";", firstLine: 4}), 'table = pd.read_csv("s.txt", sep=";", skiprows=3, names=["x", "y", "v", "w"], ' +
    'skipinitialspace=True, float_precision="round_trip")');
  assert.equal(reading({named: false, firstLine: 1}), 'table = np.genfromtxt("s.txt")');
  assert.equal(reading({named: false, firstLine: 3, separator: ";"}), 'table = np.genfromtxt("s.txt", delimiter=";", skip_header=2)');
  assert.equal(reading({}, "s.npy"), 'table = np.load("s.npy")');
  assert.ok(fit({named: false}).includes('f = csrbf.fit(table[:, [0, 1]], table[:, 2], weights=table[:, 3], loss="student")'));
  const points = (flags) => pythonLines({command: "fit", inputs: ["s.las"], flags, outputs: [["-o", "f.csrbf"]]});
  assert.ok(points([]).includes('f = csrbf.fit(table, "z", coordinates=["x", "y"])'));
  assert.ok(points([["--coordinates", "y,x"], ["--values", "intensity"], ["--weights", "z"]]).includes(
    'f = csrbf.fit(table, "intensity", coordinates=["y", "x"], weights="z")'));
});

test("a function on a grid becomes a landscape within its box", () => {
  const picture = landscape({shape: [2, 3], values: [0, 1, 2, 3, 4, 5]}, {bounds: {lo: [0, 0], hi: [2, 1]}, coordinates: ["x", "y"], values: ["depth"]});
  assert.deepEqual(picture.axes, ["x", "y", "depth"]);
  assert.deepEqual(picture.axisRanges, [[0, 2], [0, 1], [0, 5]]);
  const {halfSides} = decode.frame(picture.low, picture.high);
  picture.mesh.positions.forEach((value, i) => assert.ok(Math.abs(value) <= halfSides[i % 3] + 1e-6));
  assert.equal(picture.mesh.triangles.length / 3, 4);
});

test("files with numbered names are a series, in the order of the numbers", () => {
  const image = (name, more = {}) => ({name, kind: "image", made: false, ...more});
  const items = ["f_10.png", "f_2.png", "f_1.png"].map((name) => image(name));
  const all = [...items, image("other.png"), image("f_3.png", {made: true})];
  assert.deepEqual(seriesOf(items[0], all).map(({name}) => name), ["f_1.png", "f_2.png", "f_10.png"]);
  assert.ok(isSeries(items));
  assert.ok(!isSeries(items.slice(1)));
  assert.ok(!isSeries([...items, image("other.png")]));
  assert.equal(framesOf(items[1], all, {}).count, 3);
  const volume = {name: "v.mha", kind: "volume", made: false};
  const {count, flags, look} = framesOf(volume, [volume], {kind: "volume", size: [4, 5, 6], frames: 1});
  assert.deepEqual([count, flags, look.size, look.kind], [6, [["--slices-are-frames", true]], [4, 5, 1], "image"]);
  assert.equal(framesOf(volume, [volume], {size: [4, 5, 6], frames: 9}).count, 9);
  assert.deepEqual(labelFiles([{name: "v-track/labels_0001.mha"}, {name: "v-track/measures.csv"}, {name: "v-track/labels_0000.mha"}]),
    ["v-track/labels_0000.mha", "v-track/labels_0001.mha"]);
  assert.deepEqual(contourFiles([{name: "v-track/labels_0000.mha"}, {name: "v-track/contours_0000.svg"}]), ["v-track/contours_0000.svg"]);
  assert.deepEqual([contourExtension({kind: "volume"}), contourExtension(look)], ["ply", "svg"]);
});
