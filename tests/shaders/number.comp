#version 460
// What the hot reload test starts from.
layout(local_size_x = 1) in;
layout(binding = 3) writeonly buffer Result { uint result; };

void main() { result = 7; }
