// Prints the errors that the validator of Khronos finds in the files of a folder: see `verdicts.rs`.
//   npm install gltf-validator && node record.mjs FOLDER
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import validator from "gltf-validator";

const folder = process.argv[2];
for (const name of readdirSync(folder).sort()) {
  const externalResourceFunction = async (uri) => new Uint8Array(readFileSync(join(folder, decodeURIComponent(uri))));
  const options = { uri: name, externalResourceFunction };
  const report = await validator.validateBytes(new Uint8Array(readFileSync(join(folder, name))), options).catch((e) => e);
  const messages = report.issues?.messages ?? [{ severity: 0, code: "UNREADABLE" }];
  const codes = new Set(messages.filter((m) => m.severity === 0).map((m) => m.code));
  console.log(`${name.replace(/\.gltf$/, "")}: ${[...codes].sort().join(" ")}`.trimEnd());
}
