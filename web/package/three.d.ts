import type { BufferGeometry, Mesh, MeshBasicMaterial, Object3D } from 'three';
import type { Relighter, RelighterWorker } from './relumine.js';

/** The receivers of each mesh in an object, one for each vertex: the one at the same place whose normal is nearest. -1 for
 *  vertices that no triangle has.
 *
 *  The object is the glTF's scene that the precompute had; where it stands in a larger world counts for nothing. A mesh
 *  without normals gets a geometry with flat ones. Throws a RelumineError where a vertex is not the scene's.
 *
 *  positions, normals: those of a Relighter. */
export function receiversOf(object: Object3D, positions: Float32Array, normals: Float32Array):
    { mesh: Mesh; geometry: BufferGeometry; receivers: Int32Array }[];

/** An object that is drawn in the light of a scene.
 *
 *  Its meshes get materials that show radiance times the base colour, with its texture, and vertex colours of their own.
 *  Surfaces are matt: highlights, emission and normal maps are not shown. */
export class LitObject {
    private constructor();
    /** Changes the object's materials and geometries, once. */
    static of(object: Object3D, scene: Relighter | RelighterWorker): Promise<LitObject>;
    /** Parts of the scene that the object does not have, such as a floor of `precompute --floor`: add it to the object. */
    readonly rest?: Mesh<BufferGeometry, MeshBasicMaterial>;
    /** Shows the scene's radiance as it is now. */
    update(): Promise<void>;
}
