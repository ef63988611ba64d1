// What the report's 3-D view takes from three.js; refresh.sh bundles these and what they need, nothing else.
export { BoxGeometry, BufferAttribute, BufferGeometry, DoubleSide, EdgesGeometry, GLSL3, Group, InstancedBufferGeometry, InstancedInterleavedBuffer, InterleavedBufferAttribute, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, PerspectiveCamera, Scene, ShaderMaterial, Spherical, Vector3, WebGLRenderer } from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
