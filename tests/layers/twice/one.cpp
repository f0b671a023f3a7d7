namespace {

constexpr int limit = 1;

}  // namespace
