"""3MF files as slicers and CAD programs write them: several objects, components, transforms, units, models in
other files of the package."""
import zipfile

from harness import *

CORE = 'http://schemas.microsoft.com/3dmanufacturing/core/2015/02'
PRODUCTION = (
    'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" requiredextensions="p"'
)
TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?><Types'
    ' xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels"'
    ' ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model"'
    ' ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)


def mesh(size):
    """A cube from 0 to `size`."""
    triangles = box((size, size, size), (size / 2, size / 2, size / 2))
    points = sorted({point for triangle in triangles for point in map(tuple, triangle)})
    vertices = ''.join('<vertex x="{}" y="{}" z="{}"/>'.format(*point) for point in points)
    faces = ''.join(
        '<triangle v1="{}" v2="{}" v3="{}"/>'.format(*(points.index(tuple(point)) for point in triangle))
        for triangle in triangles
    )
    return f'<mesh><vertices>{vertices}</vertices><triangles>{faces}</triangles></mesh>'


def model(objects, items, unit='millimeter', more=''):
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><model unit="{unit}" xml:lang="en-US" xmlns="{CORE}" {more}>'
        f'<resources>{objects}</resources>{items}</model>'
    )


def relation(target):
    return (
        '<?xml version="1.0" encoding="UTF-8"?><Relationships'
        ' xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship'
        f' Target="{target}" Id="rel0"'
        ' Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    )


def package(path, main, **others):
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as out:
        for name, text in {
            '[Content_Types].xml': TYPES,
            '_rels/.rels': relation('/3D/3dmodel.model'),
            '3D/3dmodel.model': main,
            **others,
        }.items():
            out.writestr(name, text)
    return path


def info(path):
    outcome = palpate('info', path, '--json')
    expect(outcome.code == 0, outcome)
    return json.loads(outcome.out)['meshes'][0]


def near(a, b):
    return all(abs(x - y) < 1e-7 for x, y in zip(a, b))  # coordinates are floats


def test_objects_components_and_transforms():
    folder = Folder()
    objects = (
        f'<object id="1" name="cube" type="model">{mesh(10)}</object><object id="2" name="small"'
        f' type="model">{mesh(5)}</object><object id="3" name="pair" type="model"><components><component'
        ' objectid="1"/><component objectid="2" transform="0 1 0 -1 0 0 0 0 1 30 0'
        ' 0"/></components></object>'
    )
    build = (
        '<build><item objectid="3" transform="1 0 0 0 1 0 0 0 1 0 0 100"/><item objectid="1" transform="-1 0'
        ' 0 0 1 0 0 0 1 0 0 0"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 50 0"/></build>'
    )
    read = info(package(folder / 'several.3mf', model(objects, build)))
    parts = {part['path']: part for part in read['parts']}
    expect(
        list(parts) == ['several/pair/cube', 'several/pair/small', 'several/cube', 'several/cube#2'],
        list(parts),
    )
    expect(
        near(parts['several/pair/cube']['bounds']['min'], (0, 0, 0.1))
        and near(parts['several/pair/cube']['bounds']['max'], (0.01, 0.01, 0.11)),
        parts,
    )
    # A quarter turn about z, then along x: y becomes −x.
    expect(
        near(parts['several/pair/small']['bounds']['min'], (0.025, 0, 0.1))
        and near(parts['several/pair/small']['bounds']['max'], (0.03, 0.005, 0.105)),
        parts,
    )
    expect(
        near(parts['several/cube']['bounds']['min'], (-0.01, 0, 0))
        and parts['several/cube']['orientation'] == 'outward',
        'mirrored, and still outward',
    )
    expect(near(parts['several/cube#2']['bounds']['min'], (0, 0.05, 0)), parts)
    expect(
        read['unit'] == 'm'
        and any('millimetre' in note for note in read['notes'])
        and any('1 mirrored' in note for note in read['notes']),
        read['notes'],
    )


def test_a_model_in_another_file_of_the_package():
    folder = Folder()
    uuid = '00000000-0000-0000-0000-{:012d}'.format
    main = model(
        (
            f'<object id="8" name="whole" p:UUID="{uuid(1)}" type="model"><components><component'
            f' p:path="/3D/Objects/cube.model" objectid="1" p:UUID="{uuid(2)}" transform="1 0 0 0 1 0 0 0 1 7'
            ' 0 0"/></components></object>'
        ),
        f'<build p:UUID="{uuid(9)}"><item objectid="8" p:UUID="{uuid(3)}"/></build>',
        more=PRODUCTION,
    )
    other = model(
        f'<object id="1" p:UUID="{uuid(4)}" name="cube" type="model">{mesh(10)}</object>',
        '<build/>',
        more=PRODUCTION,
    )
    read = info(
        package(
            folder / 'production.3mf',
            main,
            **{
                '3D/Objects/cube.model': other,
                '3D/_rels/3dmodel.model.rels': relation('/3D/Objects/cube.model'),
            },
        )
    )
    (part,) = read['parts']
    expect(
        part['path'] == 'production/whole/cube'
        and near(part['bounds']['min'], (0.007, 0, 0))
        and part['closed'],
        part,
    )


def test_every_unit_comes_in_metres():
    folder = Folder()
    for unit, metres in (
        ('micron', 1e-6),
        ('millimeter', 1e-3),
        ('centimeter', 1e-2),
        ('inch', 0.0254),
        ('foot', 0.3048),
        ('meter', 1),
    ):
        read = info(
            package(
                folder / 'cube.3mf',
                model(
                    f'<object id="1" type="model">{mesh(2)}</object>',
                    '<build><item objectid="1"/></build>',
                    unit,
                ),
            )
        )
        expect(all(abs(side / (2 * metres) - 1) < 1e-6 for side in read['size']), (unit, read['size']))
    scene = folder.save(static=[{'mesh': 'cube.3mf', 'units': 'mm'}])
    expect_refused(
        palpate('query', scene, '--pose', '0 0 0 0 0 0 1'), 3, '/static/0/units', 'states its unit'
    )


def test_what_is_broken_is_refused():
    folder = Folder()
    cube, build = f'<object id="1" type="model">{mesh(2)}</object>', '<build><item objectid="1"/></build>'
    whole = package(folder / 'cube.3mf', model(cube, build)).read_bytes()
    folder.write('cut.3mf', whole[: len(whole) // 2])
    folder.write('none.3mf', 'no package at all')
    package(folder / 'index.3mf', model(cube.replace('v1="0"', 'v1="800"', 1), build))
    package(folder / 'finite.3mf', model(cube.replace('x="0', 'x="inf', 1), build))
    package(folder / 'nothing.3mf', model(cube, '<build/>'))
    package(folder / 'unknown.3mf', model(cube, '<build><item objectid="5"/></build>'))
    package(
        folder / 'itself.3mf',
        model(
            '<object id="1" type="model"><components><component objectid="1"/></components></object>', build
        ),
    )
    doubled = cube + ''.join(
        f'<object id="{i}" type="model"><components><component objectid="{i - 1}"/><component'
        f' objectid="{i - 1}"/></components></object>'
        for i in range(2, 60)
    )
    for name in ('cut', 'none', 'index', 'finite', 'nothing', 'unknown', 'itself'):
        expect_refused(palpate('info', folder / f'{name}.3mf'), 3, f'{name}.3mf')
    # Keeps the library busy for ages.
    package(folder / 'ages.3mf', model(doubled, '<build><item objectid="59"/></build>'))
    expect_refused(
        palpate('info', folder / 'ages.3mf', '--import-seconds', '2'), 3, 'ages.3mf', '--import-seconds'
    )


def test_instances_are_counted():
    folder = Folder()
    doubled = f'<object id="1" type="model">{mesh(2)}</object>' + ''.join(
        f'<object id="{i}" type="model"><components><component objectid="{i - 1}"/><component'
        f' objectid="{i - 1}"/></components></object>'
        for i in range(2, 20)
    )
    package(folder / 'many.3mf', model(doubled, '<build><item objectid="19"/></build>'))  # 262,144 cubes
    expect_refused(palpate('info', folder / 'many.3mf'), 3, 'many.3mf', '100000 parts, instances counted')


main(globals())
