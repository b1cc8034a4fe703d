layout(location = 0) out float marked;
void main() { marked = 1.0; }
