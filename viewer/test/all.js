// The tests as one script, to be bundled.

import "./engine.test.js";
import "./page.test.js";
import "./slices.test.js";
import "./space.test.js";
import "./studio.test.js";
