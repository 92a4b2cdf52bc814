// A library that is no module: it has no entry point.
int radivoxTestEmpty() { return 0; }
