// Judges a GLB with Khronos' validator: node gltf.cjs FOLDER-OF-GLTF-VALIDATOR FILE. Exit code 1 if it finds an error or a warning.
const { readFileSync } = require('node:fs');
const [folder, file] = process.argv.slice(2);
require(folder)
  .validateBytes(new Uint8Array(readFileSync(file)))
  .then(({ issues }) => {
    issues.messages.forEach(({ code, message }) => console.log(code, message));
    process.exit(issues.numErrors + issues.numWarnings > 0 ? 1 : 0);
  });
