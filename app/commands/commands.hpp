#pragma once

#include "session.hpp"

namespace csrbf::app {

// What each command does: read, compute, write, and fill the session's report and summary. Throw on failure.

void run(const ReconstructCommand& command, Session& session);
void run(const EstimateNormalsCommand& command, Session& session);
void run(const PolygonizeCommand& command, Session& session);
void run(const RenderCommand& command, Session& session);
void run(const CurvatureCommand& command, Session& session);
void run(const CombineCommand& command, Session& session);
void run(const FitCommand& command, Session& session);
void run(const EvaluateCommand& command, Session& session);
void run(const InpaintCommand& command, Session& session);
void run(const SegmentCommand& command, Session& session);
void run(const TrackCommand& command, Session& session);
void run(const CompareCommand& command, Session& session);
void run(const InfoCommand& command, Session& session);

}  // namespace csrbf::app
