// The studio's page with the program that serves it (engine/native.js).

import {nativeEngine} from "./engine/native.js";
import {startStudio} from "./studio/app.js";

startStudio(nativeEngine());
