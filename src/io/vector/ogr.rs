//! Layers through OGR: GeoPackage with styles and metadata, GeoJSON, FlatGeobuf.
#![allow(unsafe_code, reason = "boolean fields have a subtype that the safe bindings cannot set")]

use super::spatial_index::{Bounds, SpatialIndex};
use super::table::{Field, FieldKind, Geometry, GeometryKind, Table, Value};
use crate::crs::Crs;
use crate::error::{Error, ErrorKind, Result};
use crate::io::messages::{failure, quiet, take_failures};
use crate::io::output::Output;
use crate::watch::Watch;
use gdal::errors::GdalError;
use gdal::spatial_ref::SpatialRef;
use gdal::vector::{Feature, LayerAccess, LayerOptions, sql::Dialect};
use gdal::{Dataset, DriverManager, Metadata};
use gdal_sys::{OGRErr, OGRFieldSubType, OGRFieldType, OGRwkbGeometryType};
use std::ffi::CString;

/// Rows between two looks at the watch.
const BATCH: usize = 1024;

/// Writes layers into one file.
pub(super) fn write(
    output: &Output,
    driver: &str,
    layers: &[&dyn Table],
    crs: Option<&Crs>,
    metadata: &[(String, String)],
    watch: &Watch,
) -> Result<()> {
    quiet();
    // What was said of other files is not about this one.
    take_failures();
    // A damaged GeoPackage after a power cut is no loss: it has not got its name yet.
    let _ = gdal::config::set_config_option("OGR_SQLITE_SYNCHRONOUS", "OFF");
    let target = output.target().to_path_buf();
    let wrong = |error: GdalError| failure(ErrorKind::Output, "it cannot be written", &target, &error);
    let driver_handle = DriverManager::get_driver_by_name(driver).map_err(|_| {
        Error::new(ErrorKind::Unsupported, format!("this GDAL was built without the {driver} driver")).at_path(&target)
    })?;
    let srs = crs.map(|crs| SpatialRef::from_wkt(&crs.wkt)).transpose().map_err(wrong)?;
    let mut dataset = driver_handle.create_vector_only(output.path()).map_err(wrong)?;
    let is_geopackage = driver == "GPKG";
    if is_geopackage {
        let mut transaction = dataset.start_transaction().map_err(wrong)?;
        for layer in layers {
            write_layer(&mut transaction, *layer, srs.as_ref(), is_geopackage, watch, &wrong)?;
        }
        write_styles(&transaction, layers).map_err(wrong)?;
        transaction.commit().map_err(wrong)?;
        for (key, value) in metadata {
            dataset.set_metadata_item(key, value, "").map_err(wrong)?;
        }
    } else {
        for layer in layers {
            write_layer(&mut dataset, *layer, srs.as_ref(), is_geopackage, watch, &wrong)?;
        }
    }
    dataset.close().map_err(wrong)?;
    // Before 3.7 GDAL does not return the failures of its last writes.
    let said = take_failures();
    if said.is_empty() {
        Ok(())
    } else {
        Err(Error::new(ErrorKind::Output, format!("it cannot be written: {}", said.join("; "))).at_path(&target))
    }
}

fn write_layer(
    dataset: &mut Dataset,
    table: &dyn Table,
    srs: Option<&SpatialRef>,
    is_geopackage: bool,
    watch: &Watch,
    wrong: &impl Fn(GdalError) -> Error,
) -> Result<()> {
    let description = format!("DESCRIPTION={}", table.description());
    let mut options: Vec<&str> = Vec::new();
    if is_geopackage {
        // The peaks' `id` is the feature's own: rows are found, and edited, under one number.
        options.extend(["GEOMETRY_NAME=geom", "FID=fid", "SPATIAL_INDEX=NO", description.as_str()]);
    }
    let ty = match table.geometry_kind() {
        GeometryKind::Point => OGRwkbGeometryType::wkbPoint,
        GeometryKind::Line => OGRwkbGeometryType::wkbLineString,
        GeometryKind::MultiLine => OGRwkbGeometryType::wkbMultiLineString,
        GeometryKind::Triangle => OGRwkbGeometryType::wkbPolygon25D,
    };
    {
        let layer = dataset
            .create_layer(LayerOptions { name: table.name(), srs, ty, options: Some(&options) })
            .map_err(wrong)?;
        for field in table.fields() {
            create_field(&layer, field).map_err(wrong)?;
        }
    }
    let mut index = if is_geopackage { Some(SpatialIndex::begin(dataset, table.name()).map_err(wrong)?) } else { None };
    let multi = table.geometry_kind() == GeometryKind::MultiLine;
    let mut values = Vec::new();
    let mut wkb = Vec::new();
    {
        let layer = dataset.layer(dataset.layer_count() - 1).map_err(wrong)?;
        for row in 0..table.rows() {
            values.clear();
            table.values(row, &mut values);
            let geometry = table.geometry(row);
            if let Some(index) = &mut index {
                index.add(bounds_of(&geometry));
            }
            to_wkb(&geometry, multi, &mut wkb);
            write_feature(&layer, &values, &wkb).map_err(wrong)?;
            if row % BATCH == BATCH - 1 {
                watch.advance(BATCH as u64)?;
            }
        }
    }
    if let Some(index) = index {
        index.finish(dataset).map_err(wrong)?;
    }
    watch.advance((table.rows() % BATCH) as u64)
}

/// Least x, greatest x, least y, greatest y.
fn bounds_of(geometry: &Geometry) -> Bounds {
    let mut bounds = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    let mut add = |x: f64, y: f64| {
        bounds = [bounds[0].min(x), bounds[1].max(x), bounds[2].min(y), bounds[3].max(y)];
    };
    match geometry {
        Geometry::Point(x, y) => add(*x, *y),
        Geometry::Lines(pieces) => pieces.iter().flatten().for_each(|&(x, y)| add(x, y)),
        Geometry::Triangle(corners) => corners.iter().for_each(|&[x, y, _]| add(x, y)),
    }
    bounds
}

fn create_field<L: LayerAccess>(layer: &L, field: &Field) -> gdal::errors::Result<()> {
    let (kind, subtype) = match field.kind {
        FieldKind::Integer => (OGRFieldType::OFTInteger64, OGRFieldSubType::OFSTNone),
        FieldKind::Real => (OGRFieldType::OFTReal, OGRFieldSubType::OFSTNone),
        FieldKind::Boolean => (OGRFieldType::OFTInteger, OGRFieldSubType::OFSTBoolean),
        FieldKind::Text => (OGRFieldType::OFTString, OGRFieldSubType::OFSTNone),
    };
    let name = CString::new(field.name.as_str())?;
    // SAFETY: the definition is made, used and destroyed here; the layer copies it and lives as long as its dataset.
    let result = unsafe {
        let definition = gdal_sys::OGR_Fld_Create(name.as_ptr(), kind);
        gdal_sys::OGR_Fld_SetSubType(definition, subtype);
        let result = gdal_sys::OGR_L_CreateField(layer.c_layer(), definition, 1);
        gdal_sys::OGR_Fld_Destroy(definition);
        result
    };
    if result == OGRErr::OGRERR_NONE {
        Ok(())
    } else {
        Err(GdalError::OgrError { err: result, method_name: "OGR_L_CreateField" })
    }
}

fn write_feature<L: LayerAccess>(layer: &L, values: &[Value<'_>], wkb: &[u8]) -> gdal::errors::Result<()> {
    let mut feature = Feature::new(layer.defn())?;
    for (i, value) in values.iter().enumerate() {
        match *value {
            Value::Null => feature.set_field_null(i)?,
            Value::Real(value) if value.is_nan() => feature.set_field_null(i)?,
            Value::Real(value) => feature.set_field_double(i, value)?,
            Value::Integer(value) => feature.set_field_integer64(i, value)?,
            Value::Boolean(value) => feature.set_field_integer(i, i32::from(value))?,
            Value::Text(value) => feature.set_field_string(i, value)?,
        }
    }
    feature.set_geometry(gdal::vector::Geometry::from_wkb(wkb)?)?;
    feature.create(layer)
}

/// Writes a geometry as little-endian WKB.
fn to_wkb(geometry: &Geometry, multi: bool, wkb: &mut Vec<u8>) {
    wkb.clear();
    let header = |wkb: &mut Vec<u8>, kind: u32| {
        wkb.push(1);
        wkb.extend_from_slice(&kind.to_le_bytes());
    };
    let point = |wkb: &mut Vec<u8>, x: f64, y: f64| {
        wkb.extend_from_slice(&x.to_le_bytes());
        wkb.extend_from_slice(&y.to_le_bytes());
    };
    match geometry {
        Geometry::Point(x, y) => {
            header(wkb, 1);
            point(wkb, *x, *y);
        }
        Geometry::Lines(pieces) => {
            if multi {
                header(wkb, 5);
                wkb.extend_from_slice(&(pieces.len() as u32).to_le_bytes());
            }
            for piece in pieces {
                header(wkb, 2);
                wkb.extend_from_slice(&(piece.len() as u32).to_le_bytes());
                for &(x, y) in piece {
                    point(wkb, x, y);
                }
            }
        }
        Geometry::Triangle(corners) => {
            // A polygon with z, of one ring of four points of which the last is the first.
            header(wkb, 1003);
            wkb.extend_from_slice(&1_u32.to_le_bytes());
            wkb.extend_from_slice(&4_u32.to_le_bytes());
            for &[x, y, z] in corners.iter().chain(&corners[..1]) {
                point(wkb, x, y);
                wkb.extend_from_slice(&z.to_le_bytes());
            }
        }
    }
}

/// Writes the table in which QGIS keeps the styles of a GeoPackage's layers.
fn write_styles(dataset: &Dataset, layers: &[&dyn Table]) -> gdal::errors::Result<()> {
    let run = |sql: String| dataset.execute_sql(sql, None, Dialect::DEFAULT).map(|_| ());
    let quoted = |text: &str| format!("'{}'", text.replace('\'', "''"));
    let styled: Vec<_> = layers.iter().filter_map(|layer| layer.style().map(|style| (layer.name(), style))).collect();
    if styled.is_empty() {
        return Ok(());
    }
    run("CREATE TABLE layer_styles (id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, f_table_catalog TEXT(256), \
         f_table_schema TEXT(256), f_table_name TEXT(256), f_geometry_column TEXT(256), styleName TEXT(30), \
         styleQML TEXT, styleSLD TEXT, useAsDefault BOOLEAN, description TEXT, owner TEXT(30), ui TEXT(30), \
         update_time DATETIME DEFAULT '2000-01-01T00:00:00.000Z')"
        .into())?;
    run("INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change) \
         VALUES ('layer_styles', 'attributes', 'layer_styles', '', '2000-01-01T00:00:00.000Z')"
        .into())?;
    for (name, style) in styled {
        run(format!(
            "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName, \
             styleQML, styleSLD, useAsDefault, description, owner) \
             VALUES ('', '', {}, 'geom', {}, {}, '', 1, 'written by orograph', '')",
            quoted(name),
            quoted(&style.name),
            quoted(&style.qml)
        ))?;
    }
    Ok(())
}
