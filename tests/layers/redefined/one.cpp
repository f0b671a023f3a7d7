namespace csrbf {

struct Partition {
  int order = 0;
};

}  // namespace csrbf
