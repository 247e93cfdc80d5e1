//! Rotations and linear equations for the second formulation of elastic axles.

use hardpoint::number::Vector3;

/// Rotation matrix, by rows.
pub type Rotation = [[f64; 3]; 3];

/// Returns a rotation followed by another rotation about fixed axes.
pub fn turned(rotation: &Rotation, turn: Vector3<f64>) -> Rotation {
    let angle = turn.norm();
    if angle == 0.0 {
        return *rotation;
    }
    let axis = turn * (1.0 / angle);
    let (sine, cosine) = angle.sin_cos();
    let mut found = *rotation;
    for j in 0..3 {
        let v = Vector3::new(rotation[0][j], rotation[1][j], rotation[2][j]);
        let along = axis * axis.dot(v);
        let across = v - along;
        let now = along + across * cosine + axis.cross(across) * sine;
        (found[0][j], found[1][j], found[2][j]) = (now.x, now.y, now.z);
    }
    found
}

/// Solves the equations `a x = b` by Gaussian elimination with partial pivoting.
pub fn solved(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs()))
            .unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            if factor != 0.0 {
                let (upper, lower) = a.split_at_mut(i);
                for (entry, of_pivot) in lower[0][k..].iter_mut().zip(&upper[k][k..]) {
                    *entry -= factor * of_pivot;
                }
                b[i] -= factor * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - sum) / a[k][k];
    }
    b
}
