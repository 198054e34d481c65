// Loads the module of crates/web/pkg into node, which has no fetch of files.

import { readFileSync } from "node:fs";
import init, * as module from "../pkg/incise_web.js";

await init({ module_or_path: readFileSync(new URL("../pkg/incise_web_bg.wasm", import.meta.url)) });

export default module;
