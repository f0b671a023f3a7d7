namespace {

int limit() {
  return 2;
}

}  // namespace
