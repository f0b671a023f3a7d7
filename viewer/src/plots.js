// Starts what is interactive in a report without a picture in space: values under the cursor, and frames.

import {watchPlots} from "./hover.js";
import {watchSeries} from "./film.js";

watchSeries(document);
watchPlots(document);
