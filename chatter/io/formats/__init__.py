"""Formats of files with measured FRFs, signals and matrices.

=============== ============================================================ ===================
module          responsibility                                               layout
=============== ============================================================ ===================
format_list     the list of formats; the format of a file
format          what a format is
uff58           functions of universal files: FRFs and time records          SDRC dataset 58, 58b
universal       datasets of a universal file, its units                      SDRC dataset 164
cutpro          ``.frf`` text of CutPro
csv             tables with names and units in the heading
frf_columns     FRFs of the columns of a table
npz             arrays by name, matrices                                     numpy, scipy.sparse
lvm             channels of LabVIEW files in text                            LVM
matlab          variables of MAT files                                       scipy, h5py
matlab_size     bytes and arrays of a MAT file, counted before it is read    MAT 5
xlsx            the table of a workbook                                      openpyxl
parquet         columns of Parquet files                                     pyarrow
named_arrays    arrays by name as columns of a table
sinumerik_trace traces of drives by SINUMERIK Operate                        XML
tncscope        traces of drives by TNCscope of HEIDENHAIN
mr_configurator traces of drives by MR Configurator of Mitsubishi
tdms            channels of LabVIEW files                                    npTDMS
wav             sound and other records of recorders                         RIFF WAVE
compressed_sound sound and video of telephones and recorders                  AAC, MP3, Ogg ...
matrix_market   matrices of finite element programs                          NIST Matrix Market
=============== ============================================================ ===================

A further format is one module with a `format.Format` and one line in `format_list.FORMATS`; another
package adds one with an entry point of the group ``chatter.formats``.
"""
